"""The entry's LLVM IR: `entry` is what Python calls, `give_up` hands a call on, `release` frees what it knew.

It is a template: `FIELDS` becomes loads of the fields of `entry.Spec`, words in capitals become numbers.
"""

from __future__ import annotations

from collections.abc import Mapping

API = {
    "PyCapsule_GetPointer": "ptr (ptr, ptr)",
    "PyCapsule_GetContext": "ptr (ptr)",
    "PyObject_GetAttr": "ptr (ptr, ptr)",
    "PyObject_GetBuffer": "i32 (ptr, ptr, i32)",
    "PyBuffer_Release": "void (ptr)",
    "PyObject_Call": "ptr (ptr, ptr, ptr)",
    "PyTuple_New": "ptr (i64)",
    "PyTuple_Size": "i64 (ptr)",
    "PyTuple_GetItem": "ptr (ptr, i64)",
    "PyTuple_SetItem": "i32 (ptr, i64, ptr)",
    "PyDict_New": "ptr ()",
    "PyDict_SetItem": "i32 (ptr, ptr, ptr)",
    "PyErr_Clear": "void ()",
    "PyErr_NoMemory": "ptr ()",
    "PyMem_RawMalloc": "ptr (i64)",
    "PyMem_RawFree": "void (ptr)",
    "PyEval_SaveThread": "ptr ()",
    "PyEval_RestoreThread": "void (ptr)",
    "Py_IncRef": "void (ptr)",
    "Py_DecRef": "void (ptr)",
}


def text(fields: Mapping[str, str], numbers: Mapping[str, int]) -> str:
    """The module: `fields` of a specification with their types in IR, and what the words in capitals stand for."""
    declarations = "".join(f"declare {kind.replace(' (', f' @{name}(', 1)}\n" for name, kind in API.items())
    loads = ""
    for i, (name, kind) in enumerate(fields.items()):
        loads += f"  %at.{name} = getelementptr i64, ptr %spec, i64 {i}\n  %{name} = load {kind}, ptr %at.{name}\n"
    body = _ENTRY.replace("FIELDS\n", loads)
    for word, value in numbers.items():
        body = body.replace(word, str(value))
    return declarations + body + _SLOW + _RELEASE


_RELEASE = """
; the capsule goes: let its owner go too
define void @release(ptr %capsule) nounwind {
  %owner = call ptr @PyCapsule_GetContext(ptr %capsule)
  call void @Py_DecRef(ptr %owner)
  ret void
}
"""

_SLOW = """
; slow(*args, **keywords)
define internal ptr @give_up(ptr %slow, ptr %args, i64 %nargs, ptr %names) nounwind noinline {
  call void @PyErr_Clear()
  %t = call ptr @PyTuple_New(i64 %nargs)
  %t.null = icmp eq ptr %t, null
  br i1 %t.null, label %fail, label %first
first:
  %any = icmp sgt i64 %nargs, 0
  br i1 %any, label %fill, label %keywords
fill:
  %i = phi i64 [0, %first], [%i1, %fill]
  %from = getelementptr ptr, ptr %args, i64 %i
  %x = load ptr, ptr %from
  call void @Py_IncRef(ptr %x)
  %ignored = call i32 @PyTuple_SetItem(ptr %t, i64 %i, ptr %x)
  %i1 = add i64 %i, 1
  %more = icmp slt i64 %i1, %nargs
  br i1 %more, label %fill, label %keywords
keywords:
  %no.names = icmp eq ptr %names, null
  br i1 %no.names, label %go, label %dict
dict:
  %d = call ptr @PyDict_New()
  %d.null = icmp eq ptr %d, null
  br i1 %d.null, label %drop, label %count
count:
  %k.n = call i64 @PyTuple_Size(ptr %names)
  br label %next
next:
  %k = phi i64 [0, %count], [%k1, %put]
  %k.more = icmp slt i64 %k, %k.n
  br i1 %k.more, label %put, label %go
put:
  %name = call ptr @PyTuple_GetItem(ptr %names, i64 %k)
  %pos = add i64 %nargs, %k
  %vp = getelementptr ptr, ptr %args, i64 %pos
  %v = load ptr, ptr %vp
  %ignored2 = call i32 @PyDict_SetItem(ptr %d, ptr %name, ptr %v)
  %k1 = add i64 %k, 1
  br label %next
go:
  %kw = phi ptr [null, %keywords], [%d, %next]
  %r = call ptr @PyObject_Call(ptr %slow, ptr %t, ptr %kw)
  call void @Py_DecRef(ptr %t)
  %had = icmp ne ptr %kw, null
  br i1 %had, label %drop.dict, label %end
drop.dict:
  call void @Py_DecRef(ptr %kw)
  br label %end
end:
  ret ptr %r
drop:
  call void @Py_DecRef(ptr %t)
  br label %fail
fail:
  ret ptr null
}
"""

_ENTRY = """
; struct Py_buffer: buf, obj, len, itemsize, readonly, ndim, format, shape, strides, suboffsets, internal
%buffer = type {ptr, ptr, i64, i64, i32, i32, ptr, ptr, ptr, ptr, ptr}

define ptr @entry(ptr %self, ptr %args, i64 %nargs, ptr %names) nounwind {
  %buffers = alloca [MOST x %buffer], align 16
  %pointers = alloca [MOST x ptr], align 16
  %spec = call ptr @PyCapsule_GetPointer(ptr %self, ptr null)
FIELDS
  %is.single = icmp ne i64 %single, 0
  %named = icmp ne ptr %names, null
  br i1 %named, label %one.name, label %count
one.name:                                          ; at most the keyword `out`, after all inputs
  %names.n = call i64 @PyTuple_Size(ptr %names)
  %names.1 = icmp eq i64 %names.n, 1
  %all.given = icmp eq i64 %nargs, %inputs
  %plausible = and i1 %names.1, %all.given
  br i1 %plausible, label %is.out, label %slow.call
is.out:
  %name = call ptr @PyTuple_GetItem(ptr %names, i64 0)
  %name.ok = icmp eq ptr %name, %out_name
  br i1 %name.ok, label %count, label %slow.call
count:
  %keywords = zext i1 %named to i64
  %given = add i64 %nargs, %keywords
  %with.out = add i64 %inputs, 1
  %is.bare = icmp eq i64 %given, %inputs
  %is.full = icmp eq i64 %given, %with.out
  br i1 %is.full, label %look.out, label %bare
look.out:                                          ; out=None is no out
  %out.at = getelementptr ptr, ptr %args, i64 %inputs
  %out.given = load ptr, ptr %out.at
  %out.some = icmp ne ptr %out.given, %none
  br label %types
bare:
  br i1 %is.bare, label %types, label %slow.call
types:                                             ; every dtype the very one; may run Python code
  %has.out = phi i1 [%out.some, %look.out], [false, %bare]
  %has.out.n = zext i1 %has.out to i64
  %arrays = add i64 %inputs, %has.out.n
  br label %type
type:
  %k = phi i64 [0, %types], [%k1, %type.next]
  %xp = getelementptr ptr, ptr %args, i64 %k
  %x = load ptr, ptr %xp
  %d = call ptr @PyObject_GetAttr(ptr %x, ptr %dtype_name)
  %d.none = icmp eq ptr %d, null
  br i1 %d.none, label %slow.call, label %type.got
type.got:
  call void @Py_DecRef(ptr %d)
  %d.ok = icmp eq ptr %d, %dtype
  br i1 %d.ok, label %type.next, label %slow.call
type.next:
  %k1 = add i64 %k, 1
  %k.more = icmp slt i64 %k1, %arrays
  br i1 %k.more, label %type, label %result
result:                                            ; the result's array: given, or a new one
  br i1 %has.out, label %borrow, label %make
borrow:
  %theirs.at = getelementptr ptr, ptr %args, i64 %inputs
  %theirs = load ptr, ptr %theirs.at
  call void @Py_IncRef(ptr %theirs)
  br label %hold
make:
  %fresh = call ptr @PyObject_Call(ptr %allocate, ptr %allocate_args, ptr null)
  %fresh.none = icmp eq ptr %fresh, null
  br i1 %fresh.none, label %error, label %hold
hold:
  %out = phi ptr [%theirs, %borrow], [%fresh, %make]
  br label %acquire
acquire:                                           ; inputs, then the result: of one sample, or all of n
  %j = phi i64 [0, %hold], [%j1, %take]
  %n.before = phi i64 [1, %hold], [%n, %take]
  %many.before = phi i64 [0, %hold], [%many, %take]
  %b = getelementptr %buffer, ptr %buffers, i64 %j
  %is.result = icmp eq i64 %j, %inputs
  %yp = getelementptr ptr, ptr %args, i64 %j
  br i1 %is.result, label %the.result, label %an.input
an.input:
  %y.in = load ptr, ptr %yp
  br label %get
the.result:
  br label %get
get:
  %y = phi ptr [%y.in, %an.input], [%out, %the.result]
  %flags = phi i32 [READ, %an.input], [WRITE, %the.result]
  %rc = call i32 @PyObject_GetBuffer(ptr %y, ptr %b, i32 %flags)
  %rc.ok = icmp sge i32 %rc, 0
  br i1 %rc.ok, label %check, label %let.go
check:
  %row = mul i64 %j, ROW
  %shape.at = getelementptr i64, ptr %shapes, i64 %row
  %shape.p = getelementptr %buffer, ptr %b, i32 0, i32 7
  %shape = load ptr, ptr %shape.p
  %nd.p = getelementptr %buffer, ptr %b, i32 0, i32 5
  %nd.32 = load i32, ptr %nd.p
  %nd = sext i32 %nd.32 to i64
  %nd.want = load i64, ptr %shape.at
  %extra = sub i64 %nd, %nd.want
  %is.first = icmp eq i64 %j, 0
  %many = select i1 %is.first, i64 %extra, i64 %many.before
  %same = icmp eq i64 %extra, %many
  %sane = icmp ule i64 %many, 1
  %kind.ok = and i1 %same, %sane
  br i1 %kind.ok, label %kind, label %wrong
kind:
  %is.many = icmp eq i64 %many, 1
  br i1 %is.many, label %batch, label %counted
batch:
  %length = load i64, ptr %shape
  br label %counted
counted:
  %rows = phi i64 [1, %kind], [%length, %batch]
  %n = select i1 %is.first, i64 %rows, i64 %n.before
  %n.ok = icmp eq i64 %rows, %n
  %len.p = getelementptr %buffer, ptr %b, i32 0, i32 2
  %len = load i64, ptr %len.p
  %len.at = getelementptr i64, ptr %shape.at, i64 1
  %len.one = load i64, ptr %len.at
  %len.want = mul i64 %len.one, %n
  %len.ok = icmp eq i64 %len, %len.want
  %both = and i1 %n.ok, %len.ok
  br i1 %both, label %axis, label %wrong
axis:
  %i = phi i64 [0, %counted], [%i1, %axis.is]
  %i.more = icmp slt i64 %i, %nd.want
  br i1 %i.more, label %axis.is, label %take
axis.is:
  %s.i = add i64 %i, %many
  %s.p = getelementptr i64, ptr %shape, i64 %s.i
  %s = load i64, ptr %s.p
  %i2 = add i64 %i, 2
  %want.p = getelementptr i64, ptr %shape.at, i64 %i2
  %want = load i64, ptr %want.p
  %s.ok = icmp eq i64 %s, %want
  %i1 = add i64 %i, 1
  br i1 %s.ok, label %axis, label %wrong
take:
  %buf = load ptr, ptr %b
  %slot = getelementptr ptr, ptr %pointers, i64 %j
  store ptr %buf, ptr %slot
  %j1 = add i64 %j, 1
  %j.more = icmp sle i64 %j1, %inputs
  br i1 %j.more, label %acquire, label %code.which
code.which:                                        ; compiled yet?
  %address.at = getelementptr ptr, ptr %code, i64 %many
  %kernel = load atomic ptr, ptr %address.at acquire, align 8
  %scratch.i = add i64 %many, 2
  %scratch.at = getelementptr i64, ptr %code, i64 %scratch.i
  %scratch = load i64, ptr %scratch.at
  %no.code = icmp eq ptr %kernel, null
  br i1 %no.code, label %let.go.all, label %how.many
how.many:
  br i1 %is.many, label %enough, label %unit
enough:                                            ; n > 0, and no more than are worth a thread each
  %any = icmp sgt i64 %n, 0
  %most.at = getelementptr i64, ptr %code, i64 4
  %most = load i64, ptr %most.at
  %few = icmp sle i64 %n, %most
  %is.alone = icmp ne i64 %alone, 0
  %threads.n = load i64, ptr %threads
  %no.threads = icmp eq i64 %threads.n, 1
  %not.shared = or i1 %no.threads, %is.alone
  %here = or i1 %few, %not.shared
  %simple = and i1 %any, %here
  br i1 %simple, label %apart, label %let.go.all
apart:                                             ; the result must not lie over an input not yet read
  %last.b = getelementptr %buffer, ptr %buffers, i64 %inputs
  %out.from = load i64, ptr %last.b
  %out.len.p = getelementptr %buffer, ptr %last.b, i32 0, i32 2
  %out.len = load i64, ptr %out.len.p
  %out.to = add i64 %out.from, %out.len
  br label %apart.next
apart.next:
  %o = phi i64 [0, %apart], [%o1, %apart.next]
  %ob = getelementptr %buffer, ptr %buffers, i64 %o
  %in.from = load i64, ptr %ob
  %in.len.p = getelementptr %buffer, ptr %ob, i32 0, i32 2
  %in.len = load i64, ptr %in.len.p
  %in.to = add i64 %in.from, %in.len
  %before = icmp ule i64 %in.to, %out.from
  %after = icmp ule i64 %out.to, %in.from
  %is.apart = or i1 %before, %after
  %o1 = add i64 %o, 1
  %o.more = icmp slt i64 %o1, %inputs
  %o.next = and i1 %is.apart, %o.more
  br i1 %o.next, label %apart.next, label %apart.all
apart.all:
  br i1 %is.apart, label %unit, label %let.go.all
unit:                                              ; quaternions of norm 1, or somebody must say so
  %q.first = load ptr, ptr %pointers
  %q.size.p = load i64, ptr %strides
  %item = select i1 %is.single, i64 2, i64 3
  %q.bytes = shl i64 %q.size.p, %item
  %q.none = icmp eq i64 %quaternions, 0
  br i1 %q.none, label %run, label %sample
sample:
  %m = phi i64 [0, %unit], [%m1, %sample.ok]
  %q.offset = mul i64 %m, %q.bytes
  %q = getelementptr i8, ptr %q.first, i64 %q.offset
  br label %unit.next
unit.next:
  %u = phi i64 [0, %sample], [%u1, %unit.ok]
  %u.more = icmp slt i64 %u, %quaternions
  br i1 %u.more, label %norm, label %sample.ok
sample.ok:
  %m1 = add i64 %m, 1
  %m.more = icmp slt i64 %m1, %n
  br i1 %m.more, label %sample, label %run
norm:
  %u.at = getelementptr i64, ptr %quaternion_at, i64 %u
  %at = load i64, ptr %u.at
  br label %square
square:
  %c = phi i64 [0, %norm], [%c1, %squared]
  %sum = phi double [-1.0, %norm], [%sum1, %squared]
  %e = add i64 %at, %c
  br i1 %is.single, label %short, label %long
short:
  %e.p4 = getelementptr float, ptr %q, i64 %e
  %e.4 = load float, ptr %e.p4, align 1
  %e.48 = fpext float %e.4 to double
  br label %squared
long:
  %e.p8 = getelementptr double, ptr %q, i64 %e
  %e.8 = load double, ptr %e.p8, align 1
  br label %squared
squared:
  %e.v = phi double [%e.48, %short], [%e.8, %long]
  %e.2 = fmul double %e.v, %e.v
  %sum1 = fadd double %sum, %e.2
  %c1 = add i64 %c, 1
  %c.more = icmp slt i64 %c1, 4
  br i1 %c.more, label %square, label %unit.check
unit.check:
  %minus = fneg double %sum1
  %high = fcmp ogt double %sum1, 1.9e-6
  %low = fcmp ogt double %minus, 1.9e-6
  %off = or i1 %high, %low
  %u1 = add i64 %u, 1
  br i1 %off, label %let.go.all, label %unit.ok
unit.ok:
  br label %unit.next
run:
  %small = icmp sle i64 %scratch, STACK
  br i1 %small, label %stack, label %heap
stack:
  %on.stack = alloca i8, i64 %scratch, align 64
  br label %compute
heap:
  %room = add i64 %scratch, 64
  %block = call ptr @PyMem_RawMalloc(i64 %room)
  %block.none = icmp eq ptr %block, null
  br i1 %block.none, label %no.memory, label %align
align:
  %block.i = ptrtoint ptr %block to i64
  %up = add i64 %block.i, 63
  %aligned.i = and i64 %up, -64
  %aligned = inttoptr i64 %aligned.i to ptr
  br label %compute
compute:
  %memory = phi ptr [%on.stack, %stack], [%aligned, %align]
  %block.kept = phi ptr [null, %stack], [%block, %align]
  br i1 %is.many, label %others.may, label %only.one
only.one:
  call void %kernel(i64 1, ptr %memory, ptr %pointers, ptr %strides)
  br label %computed
others.may:                                        ; other threads of Python may run meanwhile
  %state = call ptr @PyEval_SaveThread()
  call void %kernel(i64 %n, ptr %memory, ptr %pointers, ptr %strides)
  call void @PyEval_RestoreThread(ptr %state)
  br label %computed
computed:
  br i1 %small, label %done.first, label %free
free:
  call void @PyMem_RawFree(ptr %block.kept)
  br label %done.first
done.first:
  br label %done
done:
  %r = phi i64 [0, %done.first], [%r1, %done]
  %rb = getelementptr %buffer, ptr %buffers, i64 %r
  call void @PyBuffer_Release(ptr %rb)
  %r1 = add i64 %r, 1
  %r.more = icmp sle i64 %r1, %inputs
  br i1 %r.more, label %done, label %return
return:
  ret ptr %out
no.memory:
  %ignored = call ptr @PyErr_NoMemory()
  br label %let.go.all
wrong:                                             ; this buffer too, then those before it
  call void @PyBuffer_Release(ptr %b)
  br label %let.go
let.go.all:
  %failed = phi i1 [true, %no.memory], [false, %unit.check], [false, %code.which], [false, %enough], [false, %apart.all]
  br label %release
let.go:
  br label %release
release:
  %held = phi i64 [%with.out, %let.go.all], [%j, %let.go]
  %fatal = phi i1 [%failed, %let.go.all], [false, %let.go]
  br label %release.next
release.next:
  %h = phi i64 [%held, %release], [%h1, %release.one]
  %h.none = icmp eq i64 %h, 0
  br i1 %h.none, label %released, label %release.one
release.one:
  %h1 = sub i64 %h, 1
  %hb = getelementptr %buffer, ptr %buffers, i64 %h1
  call void @PyBuffer_Release(ptr %hb)
  br label %release.next
released:
  call void @Py_DecRef(ptr %out)
  br i1 %fatal, label %error, label %slow.call
slow.call:
  %answer = call ptr @give_up(ptr %slow, ptr %args, i64 %nargs, ptr %names)
  ret ptr %answer
error:
  ret ptr null
}
"""
