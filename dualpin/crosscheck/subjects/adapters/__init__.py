"""Shipped subjects: one file a library, each with a class `Subject` that is made in the library's own environment.

A file imports its library inside the class, knows nothing of dualpin, and is loaded by `apart/serve.py`.
"""
