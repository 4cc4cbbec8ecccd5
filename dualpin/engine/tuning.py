"""The constants of the engine that were chosen by measurement, with the measurement and the machine.

Machines: "Zen 4", an AMD EPYC; "Emerald Rapids", an Intel Xeon; "Xeon", an Intel Xeon with AMX and 2 MiB of
second-level cache a core, whose model the host does not report.  All have AVX-512, two cores of a shared machine,
Python 3.11, NumPy 2.4, llvmlite 0.50 and Pinocchio 4.1; batches of 4096 on one thread unless said otherwise.
To measure again: change the number here and run `python -m validation.benchmarks`.
"""

from __future__ import annotations

# --- graph ----------------------------------------------------------------------------------------

CHUNK = 250
"""Operations in one function of straight-line code.

Emerald Rapids: Coriolis of tiago_dual compiles in 2.1 s instead of 12.9 as one block and runs 1.28 times as fast,
ABA of talos 1.8 times.  Chunks of 120, 400 and 700 were up to 25 % slower.
"""

BYTECODE_FROM = 200_000
"""Operations from which a program is bytecode instead of machine code.

LLVM takes 25 to 45 us an operation, and memory in proportion.  `aba_derivatives` of tiago_dual (500 880 operations):
0.30 ms a sample as bytecode, 13 ms by NumPy; code would be some three times as fast (Emerald Rapids).
"""

LARGEST_GRAPH = 4_000_000
"""Nodes beyond which a term is not compiled: tracing and compiling a million takes 0.8 GB."""

# --- code generation ------------------------------------------------------------------------------

UNROLLED = 64
"""Columns of a row whose loads and stores are unrolled; longer rows get a loop.

Xeon: loops for all rows cost RNEA of panda 8 %; none at all gain 5 % (FK of panda) or nothing, and CRBA of talos
compiles in 1.5 s instead of 0.3.
"""

TOGETHER = 32
"""Bytes of angles whose sines and cosines a kernel for one configuration computes at a time.

Xeon: RNEA of ur5 takes 75 ns with 32 bytes, 106 with 64 (panda 117 and 135); loaded from the slots to which the row was
copied, instead of from the row, 98 and 123: a load that needs bytes of two stores stalls.
"""

WHOLE_LINES_FROM = 4
"""Vectors in a row of results from which it is stored as whole cache lines.

Shorter rows are mostly first and last lines, which need the general store in any case.
"""

STREAM_FROM = 8 << 20
"""Bytes of results from which stores are non-temporal, until it is measured (`jit.stores`).

Zen 4, all joint poses of panda 65 536 times (75 MB): 0.04 us each instead of 0.17.  From 2 MiB on: no gain.
"""

# --- compiling and linking ------------------------------------------------------------------------

QUICK_FROM = 40_000
"""Operations beyond which LLVM optimises less.

A third of the time to compile, and 10 to 20 % more to run (Emerald Rapids).
"""

SOON_FROM = 100
"""Operations from which the first sample of all is answered by bytecode.

Emerald Rapids, kernels for one sample of panda, 684 / 1881 / 3636 operations (RNEA, Coriolis, RNEA derivatives): LLVM
takes 9 / 8 / 10 ms instead of 40 / 88 / 190 for code (21 / 40 / 79 without optimising).  At 79 operations: no gain.
"""

SOON_SAMPLES = 1024
"""Samples of a first batch up to which bytecode for one sample computes them, while a thread compiles for batches.

Xeon, second derivatives of panda (16 600 operations): 20 ms for so many, where a compilation takes 0.5 s.
"""

PROCESSES_FROM = 30_000
"""Nodes of a graph from which several processes compile: each takes 0.1 s to start.

Emerald Rapids, two processes: Coriolis of tiago_dual 2.1 s instead of 3.7, RNEA derivatives 3.1 instead of 5.0.
"""

PROCESSES = 4
"""Processes that compile one program, at most."""

KERNELS_PER_LINKER = 64
"""Kernels of one linker (ORC).  It keeps the names of what it linked, 11 kB a kernel, until the last is deleted.

One linker for many kernels: 0.4 ms to link one, against 1.5 ms for an execution engine each (Emerald Rapids).
"""

# --- calling --------------------------------------------------------------------------------------

PARALLEL_FROM = 300e-6
"""Seconds of work from which several threads are used: waking a thread takes 20 to 50 us."""

PART = 100e-6
"""Seconds of work that a thread takes at a time: long compared with taking it, short compared with the last wait.

With both, two threads are 1.5 to 2.0 times as fast as one on 65 536 samples (RNEA and ABA of panda and talos).
"""

STACK = 4 * 1024
"""Bytes of scratch that a fast call takes from the stack; more comes from the heap.

At most a page, since the guard of a stack is one page: threads with stacks of 32 KiB are safe.
"""

CALL_SECONDS, OPERATION_SECONDS, NUMBER_SECONDS = 1e-9, 4e-10, 3e-10
"""Estimated seconds of a sample: constant, for each operation of a tile (divided by its lanes), for each number.

Two or three instructions a nanosecond, and the memory; only used to decide on threads.
"""

# --- GPUs -----------------------------------------------------------------------------------------
# derived from the limits of Nvidia's architectures 8.0 to 9.0 (255 registers a thread, 65 536 registers and up to
# 228 KiB of shared memory a multiprocessor), and used for all figures of validation/benchmarks/gpu (H100); none of
# them was varied on a device

GPU_ANGLES = 8
"""Sines and cosines computed together, so that their long dependency chains overlap."""

GPU_PART = 8_000
"""Operations of one function: the time of assemblers is more than linear, and registers are limited."""

GPU_LONGEST = 150_000
"""Operations beyond which a program is refused: its code alone would be larger than the caches of a GPU."""

GPU_STAGED = 896
"""Bytes of shared memory for a thread: 256 threads, the most with all registers, then fill a multiprocessor.

Wider rows are read and written without it: the mass matrix of talos as rows 32 million a second, as columns 268 (H100).
"""

GPU_THREADS = 128
"""Threads of a block, at most."""

GPU_RESIDENT = 2
"""Resident blocks of a multiprocessor: more would leave too few registers for each thread."""

GPU_LOADS = 16
"""Loads of a warp from global memory that are in flight together."""
