"""Code generation: a schedule as the text of LLVM IR."""
