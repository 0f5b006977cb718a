"""Masses that MuJoCo gives the bodies of tests/data/meshes.xml, whose geoms are meshes.

    python mesh_mass_vectors.py --out FOLDER
"""

import argparse
import json
import pathlib

import mujoco
import numpy as np

DATA = pathlib.Path(__file__).parents[2] / "crates/cylindroid/tests/data"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=pathlib.Path, required=True)
    folder = parser.parse_args().out
    model = mujoco.MjModel.from_xml_path(str(DATA / "meshes.xml"))
    bodies = {}
    for i in range(1, model.nbody):
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, model.body_iquat[i])
        rotation = rotation.reshape(3, 3)
        inertia = rotation @ np.diag(model.body_inertia[i]) @ rotation.T
        bodies[model.body(i).name] = [
            float(model.body_mass[i]),
            *model.body_ipos[i].tolist(),
            *inertia[np.triu_indices(3)].tolist(),
        ]
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"mujoco": mujoco.__version__, "bodies": bodies}, indent=1)
    (folder / "meshes.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
