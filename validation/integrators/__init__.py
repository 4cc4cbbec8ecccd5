"""The study of integrators: which method and which step, measured."""
