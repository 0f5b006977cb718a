#!/usr/bin/env python3
"""Write reference vectors of hyperbolic singular values, polar decompositions and eigenscrews.

    VENV/bin/python xtask/vectors/pitch_form_vectors.py \
        --out crates/cylindroid/tests/vectors/pitch_forms

numpy's general (unsymmetric) eigensolver, where the library uses factors and Jacobi rotations:
`squares` are the nonzero eigenvalues of J M^-1 J^T Q_h, a 6 x 6 matrix; the polar factors come
from N = M^-1 J^T Q_h J by its eigenvectors, H = (N^2)^(1/4) and E = sign N, and W = J H^+. The
values of stiffness matrices are the eigenvalues of (2 Q_h)^-1 K. Twists and wrenches are linear first;
matrices are lists of rows.
"""

import argparse
import json
from pathlib import Path

import numpy as np


def form(h):
    one = np.eye(3)
    return np.block([[np.zeros((3, 3)), one], [one, -2 * h * one]]) / 2


def of_eigenvalues(matrix, function, zero):
    """f(N) of a matrix with real eigenvalues, f(0) = 0 below `zero`."""
    values, vectors = np.linalg.eig(matrix)
    assert np.abs(np.imag(values)).max() < 1e-9
    values = np.real(values)
    images = np.where(np.abs(values) > zero, function(values), 0.0)
    return np.real(vectors @ np.diag(images) @ np.linalg.inv(vectors))


def joints(rng, m, rank, metric):
    j = rng.normal(size=(6, rank))
    if rank < m:
        j = j @ rng.normal(size=(rank, m))
    root = rng.normal(size=(m, m))
    weights = root @ root.T + np.eye(m) if metric else np.eye(m)
    h = rng.normal()
    gram = j.T @ form(h) @ j
    n = np.linalg.solve(weights, gram)
    values = np.linalg.eigvals(j @ np.linalg.solve(weights, j.T) @ form(h))
    assert np.abs(np.imag(values)).max() < 1e-9
    squares = sorted(np.real(values), key=abs)[6 - rank :]
    stretch = of_eigenvalues(n, lambda x: np.sqrt(np.abs(x)), 1e-9)
    signs = of_eigenvalues(n, np.sign, 1e-9)
    assert np.abs(n - signs @ stretch @ stretch).max() < 1e-9
    isometry = j @ of_eigenvalues(n, lambda x: 1 / np.sqrt(np.abs(x)), 1e-9)
    return {
        "j": j.tolist(),
        "metric": weights.tolist(),
        "h": h,
        "squares": sorted(squares, reverse=True),
        "isometry": isometry.tolist(),
        "stretch": stretch.tolist(),
        "signs": signs.tolist(),
    }


def stiffness(rng, rank):
    springs = rng.normal(size=(6, rank))
    k = springs @ springs.T
    h = rng.normal()
    values = np.linalg.eigvals(np.linalg.solve(2 * form(h), k))
    assert np.abs(np.imag(values)).max() < 1e-9
    values = sorted(np.real(values), key=abs)[6 - rank :]
    return {"stiffness": k.tolist(), "h": h, "values": sorted(values, reverse=True)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    rng = np.random.default_rng(17)
    shapes = [(m, min(m, 6), metric) for m in range(1, 8) for metric in (False, True)]
    shapes += [(4, 2, False), (5, 3, True), (7, 4, True)]
    cases = {
        "generator": "xtask/vectors/pitch_form_vectors.py",
        "numpy": np.__version__,
        "joints": [joints(rng, *shape) for shape in shapes],
        "stiffness": [stiffness(rng, rank) for rank in (6, 6, 6, 5, 4, 3, 2, 1)],
    }
    out.mkdir(parents=True, exist_ok=True)
    (out / "pitch_forms.json").write_text(json.dumps(cases, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
