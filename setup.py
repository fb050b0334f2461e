from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(
    **generate_distutils_setup(
        packages=[
            "robot_vision",
            "robot_vision.calibration",
            "robot_vision.markers",
            "robot_vision.nodes",
        ],
        package_dir={"": "src"},
    )
)
