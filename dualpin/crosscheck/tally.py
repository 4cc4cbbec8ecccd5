"""Errors of one term, collected batch by batch, and their summary."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .results import AGREES, DIFFERS, NOT_COMPARED, TermResult

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Which quantiles of its scaled errors a term keeps."""


def scaled_error(x: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """max|x - ref| / max(1, max|ref|) of each row, infinite where that is no number; and where it is."""
    if x.shape[1] == 0:
        return np.zeros(len(x)), np.zeros(len(x), int)
    with np.errstate(all="ignore"):
        difference = np.abs(x - reference)
        where = difference.argmax(axis=1)
        error = np.take_along_axis(difference, where[:, None], axis=1)[:, 0] / size(reference)
    return np.where(np.isfinite(error), error, np.inf), where


def size(x: np.ndarray) -> np.ndarray:
    """max(1, max|x|) of each row."""
    return np.maximum(1.0, np.maximum(x.max(axis=1, initial=0.0), -x.min(axis=1, initial=0.0)))


def singular(left_out: int, n: int) -> str:
    """What is said of samples that were left out; nothing where there are none."""
    return f"{left_out} of {n} not compared: M is singular to working precision" if left_out else ""


@dataclass
class Tally:
    """What was found in the samples and variants so far, an array a batch.

    An error that is not a number was not compared.
    """

    columns: dict[str, list[np.ndarray]] = field(default_factory=dict)
    reason: str = ""

    def add(
        self, x: np.ndarray, reference: np.ndarray, bound: np.ndarray, samples: np.ndarray, variant: int,
        left_out: np.ndarray | None = None, rounding: np.ndarray | None = None,
    ) -> None:  # fmt: skip
        """The rows of x and reference are samples; those left out are counted and not compared.

        rounding: what it explains, where that is more than the bound.
        """
        error, where = scaled_error(x, reference)
        if left_out is not None:
            error = np.where(left_out, np.nan, error)
        pick = where[:, None]
        both = [np.take_along_axis(y, pick, axis=1)[:, 0] if y.shape[1] else np.zeros(len(y)) for y in (x, reference)]
        found = {
            "error": error, "bound": bound, "entry": where, "sample": samples, "dualpin": both[0], "oracle": both[1],
            "variant": np.full(len(error), variant), "scale": np.fmin(size(x), size(reference)),
            "rounding": bound if rounding is None else rounding,
        }  # fmt: skip
        for key, value in found.items():
            self.columns.setdefault(key, []).append(np.asarray(value))

    def rows(self, status: str = DIFFERS, most: int = 3) -> list[dict[str, Any]]:
        """Samples out of tolerance: the worst, the least and one between; of a term that agrees, the worst."""
        table = {key: np.concatenate(parts) for key, parts in self.columns.items()}
        ratio = np.where(np.isnan(table["error"]), -1.0, table["error"] / table["bound"])
        order = np.argsort(-ratio, kind="stable")
        outside = order[ratio[order] > 1] if status == DIFFERS else order[:1]
        some = outside[np.unique(np.linspace(0, len(outside) - 1, most).astype(int))] if len(outside) else outside
        return [{**{key: column[k].item() for key, column in table.items()}, "ratio": float(ratio[k])} for k in some]

    def result(self, oracle: str, given: dict[str, np.ndarray]) -> TermResult:
        """The term's result; a difference is not yet decided."""
        error, bound = (np.concatenate(self.columns[key]) for key in ("error", "bound"))
        compared = ~np.isnan(error)
        result = TermResult(
            oracle=oracle, compared=int(compared.sum()), tolerance_reason=self.reason, status=NOT_COMPARED
        )
        result.left_out = int((~compared).sum())
        if not compared.any():
            result.reason = "M is singular to working precision in every sample"
            return result
        result.note = singular(result.left_out, len(error))
        result.settle(AGREES if (error[compared] <= bound[compared]).all() else DIFFERS)
        worst = self.rows(result.status)[0]
        result.max_scaled_error = float(np.nanmax(error))
        result.quantiles = np.quantile(error[compared], QUANTILES, method="lower").tolist()
        result.tolerance = float(worst["bound"])
        state = {key: given[key][worst["sample"]].tolist() for key in "qva"}
        result.worst = {key: worst[key] for key in ("sample", "variant", "ratio", "entry", "dualpin", "oracle")} | state
        return result
