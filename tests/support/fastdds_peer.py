"""Builds the robot on Fast DDS, tests/interop/ros_peer.cpp, where its library and compilers are installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from repository import ROOT

SOURCES = ROOT / "tests" / "interop"
IDL = "ros_messages.idl"
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")
NEEDED = "apt install libfastrtps-dev fastddsgen g++"


def can_be_built() -> bool:
    return HEADER.is_file() and all(map(shutil.which, ("fastddsgen", "g++")))


def build(folder: Path) -> Path:
    """The program, made in an empty folder."""
    for name in (IDL, "ros_peer.cpp"):
        shutil.copy(SOURCES / name, folder)
    run = {"cwd": folder, "check": True, "capture_output": True}
    subprocess.run(["fastddsgen", "-replace", IDL], **run)
    generated = ("ros_messages.cxx", "ros_messagesPubSubTypes.cxx")
    command = ["g++", "-std=c++17", "-O0", "-o", "ros_peer", "ros_peer.cpp", *generated]
    subprocess.run([*command, "-lfastrtps", "-lfastcdr", "-lpthread"], **run)
    return folder / "ros_peer"
