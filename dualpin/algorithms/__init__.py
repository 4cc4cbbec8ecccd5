"""Rigid-body algorithms over any scalar, one a file.

All files use one notation.  Bodies b (the joints of a `Robot`) come parents first; the ground is None.

    X  pose of b in its parent: X @ m transforms m from b's frame to the parent's, X.pull(m) back
    S  joint screws, V twist, A spatial acceleration, I inertia, F wrench, all about b's own frame
    x  Vector3.cross over the dual numbers;   power(s, F)  the power of F on s

q, v, a, tau are sequences of scalars (floats, arrays, symbols, mpmath, SymPy), results are nested
lists of scalars or objects of `dualpin.spatial`.  `dualpin.call` handles arrays and their shapes.
"""
