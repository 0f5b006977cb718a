"""Reference vectors of MuJoCo: poses of bodies and sites for the MJCF loader, and the Jacobian of
the equality constraints for closed chains.

Shapes, meshes and sensors are taken out before MuJoCo reads a file: they do not move anything,
and MuJoCo refuses a model whose meshes are not there. A file that attaches other models is read as it
is.

`closed` holds configurations in which all equality constraints are met to 1e-13 (Newton's steps
with MuJoCo's own Jacobian, from a configuration at random); `jacobian` is what MuJoCo has in
`efc_J` for the rows of its equality constraints, a column for each entry of its qvel, and `rank`
numpy's. The entries of qvel are those of the joints in the order of `joints`: one for a hinge or
slide, the angular velocity in the axes of the body for a ball, and for a free body its linear
velocity in the axes of the world before that.

    python mujoco_vectors.py --out FOLDER FILE.xml ...
"""

import argparse
import json
import pathlib
import xml.etree.ElementTree as ET

import mujoco
import numpy as np


def bare(path):
    """The text of a model without what does not move it."""
    root = ET.parse(path).getroot()
    for default in root.iter("default"):
        default.attrib.pop("group", None)  # robosuite writes one; MuJoCo refuses it
    for section in ("sensor", "contact", "asset", "visual", "statistic", "actuator", "keyframe"):
        for node in root.findall(section):
            root.remove(node)
    for parent in root.iter():
        parent.attrib.pop("material", None)
        for node in list(parent):
            if node.tag in ("geom", "camera", "light", "mesh", "material", "texture"):
                parent.remove(node)
    ET.SubElement(root, "compiler", boundmass="0.001", boundinertia="0.001")
    return ET.tostring(root, encoding="unicode")


def of_tendon(model, tendon):
    """Places in qpos and coefficients of the joints of a tendon, of a spatial one none."""
    start = model.tendon_adr[tendon]
    places = range(start, start + model.tendon_num[tendon])
    if any(model.wrap_type[k] != mujoco.mjtWrap.mjWRAP_JOINT for k in places):
        return []
    return [(model.jnt_qposadr[model.wrap_objid[k]], model.wrap_prm[k]) for k in places]


def couple(model, qpos):
    """Joints that active equality constraints tie together linearly."""
    for _ in range(model.neq):
        for i in range(model.neq):
            if not model.eq_active0[i]:
                continue
            c, (first, second) = model.eq_data[i], (model.eq_obj1id[i], model.eq_obj2id[i])
            if second >= 0 and np.any(c[2:5] != 0):
                continue
            if model.eq_type[i] == mujoco.mjtEq.mjEQ_TENDON:
                # The last joint follows the others.
                terms = of_tendon(model, first)
                if second >= 0:
                    terms += [(joint, -c[1] * b) for joint, b in of_tendon(model, second)]
                if len(terms) < 2:
                    continue
                (last, own), rest = terms[-1], terms[:-1]
                turn = c[0] - sum(a * (qpos[j] - model.qpos0[j]) for j, a in rest)
                qpos[last] = model.qpos0[last] + turn / own
            elif model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT and second >= 0:
                a, b = (model.jnt_qposadr[j] for j in (first, second))
                qpos[a] = model.qpos0[a] + c[0] + c[1] * (qpos[b] - model.qpos0[b])


def of_joints(model, qpos):
    """In the order of the joints, some of which have no name."""
    sizes = ({0: 7, 1: 4}.get(int(kind), 1) for kind in model.jnt_type)
    return [qpos[start : start + size].tolist() for start, size in zip(model.jnt_qposadr, sizes)]


def equality(model, data, qpos):
    """Residuals of the equality constraints and their Jacobian."""
    data.qpos[:] = qpos
    mujoco.mj_fwdPosition(model, data)
    rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return data.efc_pos[rows].copy(), data.efc_J.reshape(-1, model.nv)[rows].copy()


def closed(model, data, random):
    """Configurations in which all equality constraints are met."""
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    cases = []
    for _ in range(20):
        qpos = model.qpos0.copy()
        mujoco.mj_integratePos(model, qpos, random.uniform(-1, 1, model.nv), 0.3)
        for _ in range(60):
            residual, jacobian = equality(model, data, qpos)
            if not len(residual) or np.abs(residual).max() < 1e-15:
                break
            step = -np.linalg.pinv(jacobian, 1e-9) @ residual
            mujoco.mj_integratePos(model, qpos, step, min(1.0, 0.3 / np.abs(step).max()))
        if not len(residual):
            break
        if np.abs(residual).max() < 1e-13:
            rank = int(np.linalg.matrix_rank(jacobian, rtol=1e-9))
            q = of_joints(model, qpos)
            cases.append({"q": q, "rank": rank, "jacobian": (jacobian + 0.0).tolist()})
        if len(cases) == 3:
            break
    return cases


def vectors(path, random):
    if "<attach" in path.read_text():
        model = mujoco.MjModel.from_xml_path(str(path))
    else:
        model = mujoco.MjModel.from_xml_string(bare(path))
    data = mujoco.MjData(model)
    cases = []
    for k in range(3):
        qpos = model.qpos0.copy()
        if k > 0:
            qpos += random.uniform(-1, 1, model.nq) * (0.5 if k == 1 else 2.0)
        mujoco.mj_normalizeQuat(model, qpos)
        couple(model, qpos)
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        q = of_joints(model, qpos)
        frames = {}
        for i in range(1, model.nbody):
            if model.body(i).name:
                frames[model.body(i).name] = [*data.xpos[i], *data.xquat[i]]
        for i in range(model.nsite):
            name = model.site(i).name
            if name and name not in frames:
                quat = np.zeros(4)
                mujoco.mju_mat2Quat(quat, data.site_xmat[i])
                frames[name] = [*data.site_xpos[i], *quat]
        cases.append({"q": q, "frames": frames})
    limits = {
        model.joint(j).name: model.jnt_range[j].tolist()
        for j in range(model.njnt)
        if model.jnt_limited[j] and model.jnt_type[j] >= 2
    }
    loops = int(sum(t in (0, 1) and a for t, a in zip(model.eq_type, model.eq_active0)))
    result = {"mujoco": mujoco.__version__, "limits": limits, "loops": loops, "cases": cases}
    chains = closed(model, data, random)
    if chains:
        joints = [model.joint(j).name for j in range(model.njnt)]
        result |= {"joints": joints, "closed": chains}
    return result


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--out", type=pathlib.Path, required=True)
    arguments.add_argument("files", nargs="+", type=pathlib.Path)
    options = arguments.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for path in options.files:
        name = path.parent.name if path.name == "robot.xml" else path.stem
        result = vectors(path, np.random.default_rng(1))
        (options.out / f"{name}.json").write_text(json.dumps(result) + "\n")
        ranks = [case["rank"] for case in result.get("closed", [])]
        joints = len(result["cases"][0]["q"])
        print(name, joints, "joints", result["loops"], "loops, ranks", ranks)


if __name__ == "__main__":
    main()
