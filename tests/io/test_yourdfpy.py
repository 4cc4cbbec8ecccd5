"""yourdfpy is imported without the meshes of trimesh, and nobody else's import is touched."""

import io
import sys

import numpy as np
import pytest

from dualpin.io import description

FILE = """<robot name="one"><link name="a"/><link name="b"/><joint name="j" type="revolute"><origin rpy="0.1 0.2 0.3"
xyz="1 2 3"/><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit effort="1" velocity="1" lower="-1"
upper="1"/></joint></robot>"""


def test_what_stands_for_trimesh_is_known_to_its_module_alone():
    before = {name: m for name, m in sys.modules.items() if name.partition(".")[0] in ("trimesh", "yourdfpy")}
    module = description._urdf()
    after = {name: m for name, m in sys.modules.items() if name.partition(".")[0] in ("trimesh", "yourdfpy")}
    assert before == after
    robot = module.URDF.load(io.BytesIO(FILE.encode()), build_scene_graph=False, load_meshes=False).robot
    T = robot.joints[0].origin
    assert np.allclose(T[:3, 3], [1, 2, 3]) and np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3))
    trimesh = pytest.importorskip("trimesh")
    assert module.trimesh.Scene is trimesh.Scene  # access to a mesh imports the real package


def test_the_package_has_its_module():
    package = description.yourdfpy()
    assert package.urdf is sys.modules["yourdfpy.urdf"] and package.URDF is package.urdf.URDF
    import yourdfpy

    assert yourdfpy is package
