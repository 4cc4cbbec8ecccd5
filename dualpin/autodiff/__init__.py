"""Reverse-mode rules of terms, independent of the library; used by `dualpin.torch` and `dualpin.jax`.

A rule expresses the gradient of a term by other terms.  These have rules too, so that gradients can be
differentiated again; a term without a rule raises an error.
"""
