"""scikit-robot: forward kinematics, on a fixed base."""

from importlib.metadata import version

REQUIRES = ("scikit-robot==0.4.7",)


class Subject:
    name = "skrobot"

    def __init__(self, urdf, floating):
        from skrobot.models.urdf import RobotModelFromURDF

        if floating:
            raise NotImplementedError("no floating base")
        self.version = version("scikit-robot")
        self.robot = RobotModelFromURDF(urdf_file=str(urdf))
        names = [j.name for j in self.robot.joint_list]
        self.writes = {"q": names, "v": names}

    def fk(self, q, frame):
        for joint, x in zip(self.robot.joint_list, q, strict=True):
            joint.joint_angle(float(x))
        return getattr(self.robot, frame).copy_worldcoords().T()
