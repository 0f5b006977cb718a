"""What MuJoCo says about the MJCF files of a folder, and Pinocchio about the URDFs: poses of bodies
at two random configurations, masses, limits.

A file that the program does not load is listed with its message. `q` is in the order of the joints:
qpos of MuJoCo joint by joint; a number for each joint by name for Pinocchio.

    python corpus_vectors.py FOLDER OUT.json
"""

import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pinocchio

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "vectors"))
from mujoco_vectors import couple, of_joints


def of_mujoco(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    random = np.random.default_rng(1)
    cases = []
    for size in (0.0, 1.0):
        qpos = model.qpos0 + size * random.uniform(-1, 1, model.nq)
        mujoco.mj_normalizeQuat(model, qpos)
        couple(model, qpos)
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        poses = {
            model.body(i).name: [*data.xpos[i], *data.xquat[i]]
            for i in range(1, model.nbody)
            # Bodies of motion capture are placed by the program.
            if model.body(i).name and model.body_mocapid[model.body_rootid[i]] < 0
        }
        cases.append({"q": of_joints(model, qpos), "poses": poses})
    moving = model.nv > 0 and (model.jnt_type >= 2).all()
    if moving and not (np.isin(model.eq_type, (2, 3)) & (model.eq_active0 > 0)).any():
        mujoco.mj_fwdPosition(model, data)
        matrix = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, matrix)
        cases[-1]["mass_matrix"] = matrix.tolist()
    masses = {}
    for i in range(1, model.nbody):
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, model.body_iquat[i])
        rotation = rotation.reshape(3, 3)
        inertia = rotation @ np.diag(model.body_inertia[i]) @ rotation.T
        if model.body(i).name:
            masses[model.body(i).name] = [
                model.body_mass[i],
                *model.body_ipos[i],
                *inertia[np.triu_indices(3)],
            ]
    limits = {
        model.joint(j).name: model.jnt_range[j].tolist()
        for j in range(model.njnt)
        if model.jnt_limited[j] and model.jnt_type[j] >= 2 and model.joint(j).name
    }
    armature = {
        model.joint(j).name: model.dof_armature[model.jnt_dofadr[j]]
        for j in range(model.njnt)
        if model.joint(j).name
    }
    loops = sum(t in (0, 1) and a for t, a in zip(model.eq_type, model.eq_active0))
    return {
        "cases": cases,
        "masses": masses,
        "limits": limits,
        "armature": armature,
        "loops": int(loops),
    }


def mimics(path):
    """The joints that follow others: their joints, multipliers and offsets."""
    found = {}
    for joint in ET.parse(path).getroot().findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            ratio, shift = mimic.get("multiplier", "1"), mimic.get("offset", "0")
            found[joint.get("name")] = (mimic.get("joint"), float(ratio), float(shift))
    return found


def of_pinocchio(path):
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    random = np.random.default_rng(1)
    cases = []
    for size in (0.0, 1.0):
        q = pinocchio.neutral(model)
        named = {model.names[i]: float(size * random.uniform(-1, 1)) for i in range(model.njoints)}
        follow = mimics(path)
        for _ in follow:
            for name, (leader, ratio, shift) in follow.items():
                if leader in named:
                    named[name] = ratio * named[leader] + shift
        for i in range(1, model.njoints):
            joint = model.joints[i]
            angle = named[model.names[i]]
            if joint.nv == 1:
                value = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
                q[joint.idx_q : joint.idx_q + joint.nq] = value
            else:
                named[model.names[i]] = None
        pinocchio.framesForwardKinematics(model, data, q)
        poses = {}
        for frame, placement in zip(model.frames, data.oMf):
            if frame.type == pinocchio.BODY:
                x, y, z, w = pinocchio.Quaternion(placement.rotation).coeffs()
                poses[frame.name] = [*placement.translation, w, x, y, z]
        cases.append({"q": named, "poses": poses})
    return {"cases": cases}


def main():
    folder, out = map(pathlib.Path, sys.argv[1:])
    files = {}
    for path in sorted(p for p in folder.rglob("*") if p.suffix in (".xml", ".urdf")):
        text = path.read_text(errors="replace")
        read = of_pinocchio if re.search(r"<robot[ >]", text) else of_mujoco
        if read is of_mujoco and not re.search(r"<mujoco[ >]", text):
            continue
        program = "Pinocchio" if read is of_pinocchio else "MuJoCo"
        try:
            entry = {"program": program} | read(path)
        except Exception as error:  # whatever the programs raise
            entry = {"program": program, "refused": " ".join(str(error).split())}
        files[str(path.relative_to(folder))] = entry
    out.write_text(json.dumps(files, default=float))
    loaded = sum("refused" not in entry for entry in files.values())
    print(f"{loaded} of {len(files)} files load in their own programs")


if __name__ == "__main__":
    main()
