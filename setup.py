import pathlib

from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import find_packages, setup

source = pathlib.Path(__file__).resolve().parent / "src"
setup(
    **generate_distutils_setup(
        packages=find_packages(str(source)),
        package_dir={"": "src"},
        package_data={"robot_vision.dashboard": ["page/*"]},
    )
)
