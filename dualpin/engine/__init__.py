"""The compiled engine: a term becomes a graph, the graph code, the code a kernel that takes arrays."""
