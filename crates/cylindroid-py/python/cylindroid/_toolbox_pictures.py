"""Pictures of a robot of `cylindroid.rtb`."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from ._toolbox_arguments import AXES
from ._toolbox_structure import Structure


class Pictures(Structure):
    """What a robot draws with matplotlib."""

    def _ellipse(self, q: ArrayLike | None, opt: str, kind: str, options: dict[str, Any]) -> Any:
        from . import plot

        if opt not in ("trans", "rot"):
            raise ValueError(f"opt = {opt!r}: 'trans' or 'rot'")
        q = self.mechanism.ordered(self.q if q is None else q)
        report = self.mechanism.manipulability(q, reference=self._end, task=AXES[opt])
        return plot.ellipsoid(getattr(report, kind), self.mechanism.fk(q, self._end)[:3, 3], **options)

    def vellipse(self, q: ArrayLike | None = None, opt: str = "trans", **options: Any) -> Any:
        """Draws the ellipsoid of velocities, 'trans' or 'rot'; returns the axes of matplotlib.

        The options are those of `cylindroid.plot.ellipsoid`. Default of q: `Robot.q`.
        """
        return self._ellipse(q, opt, "kinematic", options)

    def fellipse(self, q: ArrayLike | None = None, opt: str = "trans", **options: Any) -> Any:
        """Draws the ellipsoid of forces; as `vellipse`."""
        return self._ellipse(q, opt, "active_force", options)

    plot_vellipse, plot_fellipse = vellipse, fellipse

    def plot(self, q: ArrayLike | None = None, ax: Any = None) -> Any:
        """Draws the robot: `cylindroid.plot.mechanism`; returns the axes of matplotlib."""
        from . import plot

        return plot.mechanism(self.mechanism, self.q if q is None else q, ax)
