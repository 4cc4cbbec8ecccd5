"""The compiled engine: a term becomes a graph, the graph LLVM IR, and the IR a kernel for arrays."""
