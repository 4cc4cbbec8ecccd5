"""Errors of one term, gathered batch by batch, and the verdict on them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .results import AGREES, DIFFERS, NOT_COMPARED, TermResult

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Which quantiles of its scaled errors a term keeps."""


def scaled_error(x: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """max|x - ref| / max(1, max|ref|) of each row, infinite where that is no number; and where.  x is overwritten."""
    if x.shape[1] == 0:
        return np.zeros(len(x)), np.zeros(len(x), int)
    with np.errstate(all="ignore"):
        difference = np.abs(np.subtract(x, reference, out=x), out=x)
        where = difference.argmax(axis=1)
        scale = np.maximum(1.0, np.maximum(reference.max(axis=1), -reference.min(axis=1)))
        error = np.take_along_axis(difference, where[:, None], axis=1)[:, 0] / scale
    return np.where(np.isfinite(error), error, np.inf), where


@dataclass
class Tally:
    """What was found in the samples and variants so far; an error that is not a number was not compared."""

    errors: list[np.ndarray] = field(default_factory=list)
    bounds: list[np.ndarray] = field(default_factory=list)
    where: list[np.ndarray] = field(default_factory=list)
    samples: list[int] = field(default_factory=list)
    variants: list[int] = field(default_factory=list)
    reason: str = ""

    def add(self, error: np.ndarray, bound: np.ndarray, where: np.ndarray, samples: np.ndarray, variant: int) -> None:
        self.errors.append(error)
        self.bounds.append(bound)
        self.where.append(where)
        self.samples += samples.tolist()
        self.variants += [variant] * len(error)

    def result(self, oracle: str, given: dict[str, np.ndarray]) -> TermResult:
        """The term's result; a difference is not yet decided."""
        error, bound, where = map(np.concatenate, (self.errors, self.bounds, self.where))
        compared = ~np.isnan(error)
        result = TermResult(
            oracle=oracle, compared=int(compared.sum()), tolerance_reason=self.reason, status=NOT_COMPARED
        )
        if not compared.any():
            result.reason = "M is singular to working precision in every sample"
            return result
        if not compared.all():
            left_out = f"{int((~compared).sum())} of {len(error)}"
            result.note = f"{left_out} not compared: M is singular to working precision"
        ratio = np.where(compared, error / bound, -1.0)
        worst = int(ratio.argmax())
        result.max_scaled_error = float(np.nanmax(error))
        result.quantiles = np.quantile(error[compared], QUANTILES, method="lower").tolist()
        result.tolerance = float(bound[worst])
        result.settle(AGREES if ratio[worst] <= 1.0 else DIFFERS)
        sample = self.samples[worst]
        result.worst = {
            "sample": sample, "variant": self.variants[worst], "ratio": float(ratio[worst]),
            "entry": int(where[worst]),
            "q": given["q"][sample].tolist(), "v": given["v"][sample].tolist(), "a": given["a"][sample].tolist(),
        }  # fmt: skip
        return result
