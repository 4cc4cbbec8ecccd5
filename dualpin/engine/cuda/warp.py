"""The code of a warp as LLVM IR: rows to shared memory, one sample in each thread, rows to global memory.

    fetch     copies a tile of 32 rows from global to shared memory, with coalesced loads
    compute   each thread computes its sample, from its row to its row
    put       writes the results from shared to global memory

The three are the same text for a GPU and for the host, where the threads of a warp are a loop; so they are tested
without a GPU.
"""

from __future__ import annotations

from ..codegen.host import Host
from ..codegen.number import Number
from ..tuning import GPU_LOADS
from . import thread
from .layout import WARP, Layout, row
from .program import Program
from .scalar import DEVICE, GLOBAL, SHARED, Scalar, address

_G, _S = address(GLOBAL), address(SHARED)
_NVVM = """declare i32 @llvm.nvvm.read.ptx.sreg.tid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.nctaid.x()
declare void @llvm.nvvm.bar.warp.sync(i32)
"""
_END = """attributes #0 = { nounwind "no-trapping-math"="true" }
!1 = !{}
!2 = !{!"branch_weights", i32 100000, i32 1}
"""


def device(program: Program, number: Number, layout: Layout) -> str:
    """``kernel(n, array, row stride, column stride, ..., of the output, ...)`` for a GPU; strides in numbers."""
    T = number.name
    parameters = ", ".join(f"{_G} noalias %a{k}, i64 %r{k}, i64 %c{k}" for k in range(len(layout.sizes)))
    wait = "call void @llvm.nvvm.bar.warp.sync(i32 -1)" if layout.room else ""
    return f"""{_common(program, number, layout, DEVICE)}
{_NVVM}
@shared = external addrspace({SHARED}) global [0 x {T}], align 16
define ptx_kernel void @kernel(i64 %n, {parameters}) #0 {{
entry:
  %passed = alloca [{max(1, program.passed)} x {T}], align 16
  %thread = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()
  %threads = call i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
  %block = call i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
  %blocks = call i32 @llvm.nvvm.read.ptx.sreg.nctaid.x()
  %lane = and i32 %thread, {WARP - 1}
  %warp = lshr i32 %thread, 5
  %warps = lshr i32 %threads, 5
  %room = mul i32 %warp, {layout.room}
  %tile = getelementptr {T}, {_S} @shared, i32 %room
  %before = mul i32 %block, %warps
  %index = add i32 %before, %warp
  %index.wide = zext i32 %index to i64
  %begin = mul i64 %index.wide, {WARP}
  %all = mul i32 %blocks, %warps
  %all.wide = zext i32 %all to i64
  %stride = mul i64 %all.wide, {WARP}
  br label %loop
loop:
  %first = phi i64 [%begin, %entry], [%next, %sampled]
  %some = icmp slt i64 %first, %n
  br i1 %some, label %read, label %exit
read:
{_fetches(number, layout)}
  {wait}
{_sample(number, layout)}
  {wait}
{_put(number, layout)}
  %next = add i64 %first, %stride
  br label %loop
exit:
  ret void
}}
{_END}"""


def emulated(program: Program, number: Number, layout: Layout, host: Host) -> str:
    """``void kernel(i64 n, ptr tile, ptr arrays, ptr row strides, ptr column strides)``: a warp as loops.

    Where threads synchronise on a GPU, one loop over them ends and the next begins.
    """
    loads = []
    for k in range(len(layout.sizes)):
        for name, kind, base in (("a", _G, "arrays"), ("r", "i64", "rows"), ("c", "i64", "columns")):
            loads.append(f"  %{name}{k}.at = getelementptr ptr, ptr %{base}, i64 {k}")
            loads.append(f"  %{name}{k} = load {kind}, ptr %{name}{k}.at, align 8")
    fetch = _every_thread("fetch", _fetches(number, layout), "compute")
    compute = _every_thread("compute", _sample(number, layout), "put")
    put = _every_thread("put", _put(number, layout), "done")
    return f"""{_common(program, number, layout, host)}
define void @kernel(i64 %n, {_S} %tile, ptr %arrays, ptr %rows, ptr %columns) #0 {{
entry:
  %passed = alloca [{max(1, program.passed)} x {number.name}], align 16
{_lines(loads)}
  br label %loop
loop:
  %first = phi i64 [0, %entry], [%next, %done]
  %some = icmp slt i64 %first, %n
  br i1 %some, label %fetch, label %exit
{fetch}
{compute}
{put}
done:
  %next = add i64 %first, {WARP}
  br label %loop
exit:
  ret void
}}
{_END}"""


def _every_thread(name: str, body: str, following: str) -> str:
    """A loop over the threads of a warp."""
    return f"""{name}:
  br label %{name}.begin
{name}.begin:
  %{name}.lane = phi i32 [0, %{name}], [%{name}.next, %{name}.end]
{body.replace("%lane", f"%{name}.lane")}
  br label %{name}.end
{name}.end:
  %{name}.next = add i32 %{name}.lane, 1
  %{name}.more = icmp ult i32 %{name}.next, {WARP}
  br i1 %{name}.more, label %{name}.begin, label %{following}"""


def _common(program: Program, number: Number, layout: Layout, host: Host) -> str:
    """The part that is the same on all machines."""
    *inputs, out = range(len(layout.sizes))
    texts = [Scalar(number, host).declarations]
    texts += [_fetch(k, number, layout, host) for k in inputs if layout.offsets[k] is not None]
    texts += [_write(number, layout, host)] if layout.offsets[out] is not None else []
    return "\n".join([*texts, thread.functions(program, number, layout, host)])


def _fetches(number: Number, layout: Layout) -> str:
    lines = []
    for k, offset in enumerate(layout.offsets[:-1]):
        if offset is not None:
            lines.append(f"  %to{k} = getelementptr {number.name}, {_S} %tile, i32 {offset}")
            values = f"i64 %first, i32 %lane, i64 %n, {_G} %a{k}, i64 %r{k}, {_S} %to{k}"
            lines.append(f"  call void @fetch{k}({values})")
    return _lines(lines)


def _put(number: Number, layout: Layout) -> str:
    k, offset = len(layout.sizes) - 1, layout.offsets[-1]
    if offset is None:
        return ""
    return f"""  %from = getelementptr {number.name}, {_S} %tile, i32 {offset}
  call void @put(i64 %first, i32 %lane, i64 %n, {_G} %a{k}, i64 %r{k}, {_S} %from)"""


def _sample(number: Number, layout: Layout) -> str:
    """One thread's sample; the last warp may have fewer than 32."""
    lines = [
        "  %lane.wide = zext i32 %lane to i64",
        "  %sample = add i64 %first, %lane.wide",
        "  %mine = icmp slt i64 %sample, %n",
        "  br i1 %mine, label %sample.mine, label %sampled",
        "sample.mine:",
    ]
    for k, (size, offset) in enumerate(zip(layout.sizes, layout.offsets, strict=True)):
        if offset is None:
            lines.append(f"  %row{k} = mul i64 %sample, %r{k}")
            lines.append(f"  %x{k} = getelementptr {number.name}, {_G} %a{k}, i64 %row{k}")
        else:
            lines.append(f"  %in{k} = mul i32 %lane, {row(size)}")
            lines.append(f"  %row{k} = add i32 %in{k}, {offset}")
            lines.append(f"  %x{k} = getelementptr {number.name}, {_S} %tile, i32 %row{k}")
    lines.append(f"  call void @compute({thread.arguments(layout, 'c')})")
    lines += ["  br label %sampled", "sampled:"]
    return _lines(lines)


def _fetch(k: int, number: Number, layout: Layout, host: Host) -> str:
    """Copy a tile of array k to shared memory: 32 numbers at a time if rows are contiguous, else row by row."""
    size, e = layout.sizes[k], Scalar(number, host)
    for start in range(0, size, GPU_LOADS):
        steps = range(start, min(size, start + GPU_LOADS))
        values = [e.get(e.entry("%base", WARP * j, GLOBAL), GLOBAL, fixed=True) for j in steps]
        for j, x in zip(steps, values, strict=True):
            e.put(_across(e, j, size), x, SHARED)
    together, e.lines = e.lines, []
    e.put(e.entry("%target", "%j", SHARED), e.get(e.entry("%source", "%j", GLOBAL), GLOBAL, fixed=True), SHARED)
    return _tile(f"fetch{k}", number, size, together, e.lines)


def _write(number: Number, layout: Layout, host: Host) -> str:
    """A tile of results to global memory."""
    size, e = layout.sizes[-1], Scalar(number, host)
    for j in range(size):
        e.put(e.entry("%base", WARP * j, GLOBAL), e.get(_across(e, j, size), SHARED), GLOBAL)
    together, e.lines = e.lines, []
    e.put(e.entry("%source", "%j", GLOBAL), e.get(e.entry("%target", "%j", SHARED), SHARED), GLOBAL)
    return _tile("put", number, size, together, e.lines)


def _across(e: Scalar, j: int, size: int) -> str:
    """The index in shared memory of a thread's j-th number, when the warp copies contiguous rows."""
    i = e.value(f"add i32 %lane, {WARP * j}")
    if row(size) > size:
        i = e.value(f"add i32 {i}, {e.value(f'udiv i32 {i}, {size}')}")
    return e.entry("%region", i, SHARED, "i32")


def _tile(name: str, number: Number, size: int, together: list[str], one: list[str]) -> str:
    """A function that moves a tile between an array and a region of shared memory."""
    T, arguments = number.name, f"i64 %first, i32 %lane, i64 %n, {_G} %array, i64 %stride, {_S} %region"
    return f"""define internal void @{name}({arguments}) alwaysinline #0 {{
entry:
  %wide = zext i32 %lane to i64
  %left = sub i64 %n, %first
  %full = icmp sge i64 %left, {WARP}
  %packed = icmp eq i64 %stride, {size}
  %easy = and i1 %full, %packed
  br i1 %easy, label %together, label %alone
together:
  %skip = mul i64 %first, {size}
  %mine = add i64 %skip, %wide
  %base = getelementptr {T}, {_G} %array, i64 %mine
{_lines(together)}
  ret void
alone:
  %some = icmp slt i64 %wide, %left
  br i1 %some, label %walk, label %exit
walk:
  %sample = add i64 %first, %wide
  %far = mul i64 %sample, %stride
  %source = getelementptr {T}, {_G} %array, i64 %far
  %place = mul i32 %lane, {row(size)}
  %target = getelementptr {T}, {_S} %region, i32 %place
  br label %each
each:
  %j = phi i64 [0, %walk], [%j.next, %each]
{_lines(one)}
  %j.next = add i64 %j, 1
  %more = icmp slt i64 %j.next, {size}
  br i1 %more, label %each, label %exit
exit:
  ret void
}}
"""


def _lines(lines: list[str]) -> str:
    return "\n".join(lines)
