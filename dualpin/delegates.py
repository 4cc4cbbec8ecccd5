"""A table of methods whose code is in a room above, such as `Robot.to_urdf`; they are imported when called.

This is the only place where names point upward; all other imports point downward.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .locking import imported

HOMES = {
    "Comparison._repr_html_": "dualpin.report.notebook.comparison_html",
    "Comparison.plot": "dualpin.report.figures.comparison",
    "DHTable._repr_html_": "dualpin.report.notebook.dh_html",
    "DHTable.export": "dualpin.forms.export.dh_text",
    "DHTable.plot": "dualpin.report.figures.dh_table",
    "DHTable.robot": "dualpin.forms.build.assembled",
    "Diff.to_html": "dualpin.report.page.page",
    "Evaluator.__reduce__": "dualpin.call.making.restored",
    "IKResult._repr_html_": "dualpin.report.notebook.ik_html",
    "IKResult.plot": "dualpin.report.figures.solved",
    "IntegratorStudy._repr_html_": "dualpin.report.notebook.integrators_html",
    "IntegratorStudy.plot": "dualpin.report.figures.integrators",
    "IntegratorStudy.save": "dualpin.report.figures.save",
    "Excitation.plot": "dualpin.analysis.identification.plots.excitation",
    "Identification.plot": "dualpin.analysis.identification.plots.residuals",
    "KhalilTable.export": "dualpin.forms.export.khalil_text",
    "numpy.linalg": "dualpin.algebra",
    "numpy.ufunc": "dualpin.ufuncs.on_duals",
    "Report._repr_html_": "dualpin.report.notebook.report_html",
    "ReachMap._repr_html_": "dualpin.report.notebook.workspace_html",
    "ReachMap.plot": "dualpin.analysis.workspace.plots.slices",
    "Report.badge": "dualpin.crosscheck.badge.badge",
    "Report.plot": "dualpin.report.figures.validation",
    "Report.from_dict": "dualpin.crosscheck.stored.restored",
    "Report.to_dict": "dualpin.crosscheck.stored.document",
    "Report.to_html": "dualpin.report.page.page",
    "Report.to_json": "dualpin.crosscheck.stored.text",
    "Report.to_junit": "dualpin.crosscheck.exports.junit",
    "Report.to_markdown": "dualpin.crosscheck.markdown.markdown",
    "Report.to_sarif": "dualpin.crosscheck.exports.sarif",
    "Robot._bounds": "dualpin.model.limits.position_limits",
    "Robot._repr_html_": "dualpin.report.notebook.robot_html",
    "Robot.attach": "dualpin.model.attach.attached",
    "Robot.frame": "dualpin.model.frames.find",
    "Robot.kernel": "dualpin.call.kernel",
    "Robot.lift": "dualpin.model.lift.lifted",
    "Robot.sample": "dualpin.model.sampling.sample",
    "Robot.summary": "dualpin.model.describe.summary",
    "Robot.to_mjcf": "dualpin.io.write_mjcf.to_mjcf",
    "Robot.to_urdf": "dualpin.io.write.to_urdf",
    "Robot.velocity_limit": "dualpin.model.limits.velocity_limits",
    "Robot.with_rotors": "dualpin.model.rotors.with_rotors",
    "Screws._repr_html_": "dualpin.report.notebook.screws_html",
    "Screws.export": "dualpin.forms.export_screws.screws_text",
    "Screws.plot": "dualpin.report.figures.screws",
    "Screws.robot": "dualpin.forms.build_screws.from_screws",
    "ScrewTree.export": "dualpin.forms.export_screws.tree_text",
    "SimulationResult._repr_html_": "dualpin.report.notebook.simulation_html",
    "SimulationResult.plot": "dualpin.report.figures.simulation",
    "TrackingResult._repr_html_": "dualpin.report.notebook.tracking_html",
    "TrackingResult.plot": "dualpin.report.figures.tracking",
    "Trajectory.plot": "dualpin.report.figures.trajectory",
}
"""Method -> module and function; NumPy's functions on dual arrays -> the module that has them."""


def home(method: str) -> Callable[..., Any]:
    """The function that does the work of a method."""
    module, _, function = HOMES[method].rpartition(".")
    found: Callable[..., Any] = getattr(imported(module), function)
    return found
