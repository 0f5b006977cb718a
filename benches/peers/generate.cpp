// Writes C code for pose and Jacobian of one robot: Pinocchio's algorithms, recorded by CppAD and
// written by CppADCodeGen.   generate FOLDER ROBOT > ROBOT.c
#include <pinocchio/codegen/cppadcg.hpp>

#include "pinocchio_model.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string name = argv[2];
  const auto model = model_of(load(argv[1], name));

  using CG = CppAD::cg::CG<double>;
  using Scalar = CppAD::AD<CG>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  const auto recorded = model.cast<Scalar>();
  pinocchio::DataTpl<Scalar> data(recorded);
  const int n = model.nv;

  Vector q = Vector::Zero(n);
  CppAD::Independent(q);
  const auto tip = model.frames.size() - 1;
  pinocchio::computeJointJacobians(recorded, data, q);
  pinocchio::updateFramePlacement(recorded, data, tip);
  Eigen::Matrix<Scalar, 6, Eigen::Dynamic> jacobian(6, n);
  jacobian.setZero();
  pinocchio::getFrameJacobian(recorded, data, tip, pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
  Vector y(12 + 6 * n);
  for (int i = 0; i < 9; ++i) y[i] = data.oMf[tip].rotation()(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) y[9 + i] = data.oMf[tip].translation()[i];
  for (int i = 0; i < 6 * n; ++i) y[12 + i] = jacobian(i / n, i % n);
  CppAD::ADFun<CG> function(q, y);
  function.optimize("no_compare_op");

  CppAD::cg::CodeHandler<double> handler;
  CppAD::vector<CG> x(n);
  handler.makeVariables(x);
  CppAD::vector<CG> result = function.Forward(0, x);
  CppAD::cg::LanguageC<double> language("double");
  CppAD::cg::LangCDefaultVariableNameGenerator<double> names;
  std::ostringstream code;
  handler.generateCode(code, language, result, names);
  std::cout << "#include <math.h>\nvoid " << name << "(const double* x, double* y) {\n  double v["
            << handler.getTemporaryVariableCount() + 1 << "];\n" << code.str() << "}\n";
}
