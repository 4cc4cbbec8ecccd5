"""How terms are differentiated backwards, whatever library does it: `dualpin.torch` and `dualpin.jax` stand on it.

A rule says what the gradient of a term is, in other terms.  As these have rules too, gradients can be
differentiated again; where the rules end, an error says so.
"""
