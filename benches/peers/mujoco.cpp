// MuJoCo: kinematics of the whole model and the Jacobian of a site.

#include <mujoco/mujoco.h>

#include "common.hpp"

namespace {

struct Arm {
  mjModel* model;
  mjData* data;
  std::vector<double> jacobian;
  int site;

  Arm(const std::string& path, const Robot& robot) {
    char error[300] = "";
    model = mj_loadXML(path.c_str(), nullptr, error, sizeof error);
    if (!model) throw std::runtime_error(error);
    data = mj_makeData(model);
    site = mj_name2id(model, mjOBJ_SITE, "tip0");
    jacobian.resize(6 * model->nv);
    if (size_t(model->nv) != robot.n()) throw std::runtime_error("another number of joints");
  }

  void set(const double* q) {
    std::copy(q, q + model->nq, data->qpos);
    mj_kinematics(model, data);
    mj_comPos(model, data);
  }

  void tip(const double* q) {
    set(q);
    mj_jacSite(model, data, jacobian.data(), jacobian.data() + 3 * model->nv, site);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::unique_ptr<Arm>> arms;
  return serve(argc, argv, [&](const Words& words, const Robot& robot, const std::string& path) -> std::string {
    auto& slot = arms[words[1]];
    if (!slot) slot = std::make_unique<Arm>(std::string(argv[1]) + "/" + words[1] + ".xml", robot);
    Arm& arm = *slot;
    if (words[0] == "check") {
      std::vector<double> out;
      for (size_t i = 0; i < BLOCK; ++i) {
        arm.tip(robot.configuration(i));
        out.insert(out.end(), arm.data->site_xmat + 9 * arm.site, arm.data->site_xmat + 9 * arm.site + 9);
        out.insert(out.end(), arm.data->site_xpos + 3 * arm.site, arm.data->site_xpos + 3 * arm.site + 3);
        out.insert(out.end(), arm.jacobian.begin(), arm.jacobian.end());
      }
      return write(path, out);
    }
    if (words[0] == "single") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        arm.tip(q);
        keep(*arm.jacobian.data());
      });
    }
    if (words[0] == "tree") {
      return single(robot, std::stod(words[2]), [&](const double* q) {
        arm.set(q);
        keep(*arm.data->cdof);
      });
    }
    if (words[0] == "treecheck") {
      // Its columns are at centres of mass, turns first: taken to the world's origin.
      std::vector<double> out;
      const int n = arm.model->nv;
      for (size_t i = 0; i < BLOCK; ++i) {
        arm.set(robot.configuration(i));
        std::vector<double> columns(6 * n);
        for (int k = 0; k < n; ++k) {
          const double* w = arm.data->cdof + 6 * k;
          const double* v = w + 3;
          const double* c = arm.data->subtree_com + 3 * arm.model->body_rootid[arm.model->dof_bodyid[k]];
          const double at[3] = {v[0] - (w[1] * c[2] - w[2] * c[1]), v[1] - (w[2] * c[0] - w[0] * c[2]), v[2] - (w[0] * c[1] - w[1] * c[0])};
          for (int r = 0; r < 3; ++r) columns[r * n + k] = at[r], columns[(r + 3) * n + k] = w[r];
        }
        out.insert(out.end(), columns.begin(), columns.end());
      }
      return write(path, out);
    }
    return "error no task " + words[0];
  });
}
