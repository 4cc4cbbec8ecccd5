"""Code generation: a schedule as LLVM IR, text that no compiler has seen yet."""
