"""The files that a CMakeLists.txt takes are there, or are told."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

CMAKE = "project(my_bot)\nfind_package(ament_cmake REQUIRED)\n{}ament_package()\n"


@pytest.mark.parametrize(
    ("line", "lost"),
    [
        ('rosidl_generate_interfaces(${PROJECT_NAME}\n  "msg/Pose.msg"\n  "srv/Go.srv"\n  DEPENDENCIES std_msgs\n)', "msg/Pose.msg, srv/Go.srv"),
        ("add_executable(driver src/driver.cpp src/there.cpp)", "src/driver.cpp"),
        ("install(PROGRAMS scripts/one.py DESTINATION lib/${PROJECT_NAME})", "scripts/one.py"),
        ("add_executable(driver src/there.cpp)", ""),
        ("# add_executable(driver src/driver.cpp)", ""),
        ("add_executable(driver ${CMAKE_BINARY_DIR}/src/driver.cpp ${SOURCES})", ""),
        ("if(WITH_DRIVER)\n  add_executable(driver src/driver.cpp)\nendif()", ""),
        ("if(A)\n  if(B)\n    add_executable(driver src/driver.cpp)\n  endif()\nendif()", ""),
        ("if(BUILD_TESTING)\nendif()\nadd_library(driver src/driver.cpp)", "src/driver.cpp"),
        ("install(FILES config/a.py DESTINATION share/${PROJECT_NAME} OPTIONAL)", ""),
    ],
)  # fmt: skip
def test_a_file_that_cmake_takes_is_there(tmp_path: Path, line: str, lost: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", "ament_python", "ament_cmake")
    files.put("CMakeLists.txt", CMAKE.format(f"{line}\n")).put("src/there.cpp", "int main() {}\n")
    found = [f.cause for f in of_workspace(files.write(tmp_path)) if f.code == "data-file-missing"]
    assert [cause.startswith(f"CMakeLists.txt takes {lost}, but") for cause in found] == [True] * bool(lost)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("", "remove this Node, or write the program talker"),
        ("add_executable(listener src/there.cpp)", "remove this Node, or write the program talker"),
        ("add_executable(talkers src/there.cpp)", "write talkers instead of talker"),
        (
            "install(PROGRAMS scripts/talker.py DESTINATION lib/${PROJECT_NAME})",
            "write talker.py instead of talker",
        ),
        ("add_executable(talker src/there.cpp)", ""),
        ("install(PROGRAMS scripts/talker DESTINATION lib/${PROJECT_NAME})", ""),
        ("install(PROGRAMS scripts/talker.py DESTINATION lib/my_bot RENAME talk)", ""),
        ("add_executable(${PROJECT_NAME} src/there.cpp)", ""),
        ("install(DIRECTORY scripts/ DESTINATION lib/${PROJECT_NAME})", ""),
        ("include(cmake/programs.cmake)", ""),
    ],
)
def test_a_launched_program_is_one_that_cmake_makes(tmp_path: Path, line: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", "ament_python", "ament_cmake").remove("setup.py")
    files.put("CMakeLists.txt", CMAKE.format(f"{line}\n")).put("src/there.cpp", "int main() {}\n")
    files.change("launch/robot.launch.py", "executable='LISTENER'", "executable='talker'")
    files.change("launch/robot.launch.py", "        Node(package='PACKAGE', executable='DRIVER'),\n", "")
    found = [f.fix for f in of_workspace(files.write(tmp_path)) if f.code == "launch-executable"]
    assert [said.startswith(fix) for said in found] == [True, True] * bool(fix)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("", "install(DIRECTORY config launch DESTINATION"),
        ("add_executable(driver src/there.cpp)\ninstall(TARGETS driver DESTINATION lib/my_bot)", "install(DIRECTORY config launch DESTINATION"),
        ("# install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})", "install(DIRECTORY config launch DESTINATION"),
        ("install(DIRECTORY config DESTINATION share/${PROJECT_NAME})", "install(DIRECTORY launch DESTINATION"),
        ("install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})", ""),
        ("install(FILES launch/robot.launch.py DESTINATION share/${PROJECT_NAME}/launch)", ""),
        ("install(DIRECTORY . DESTINATION share/${PROJECT_NAME})", ""),
        ("foreach(name config start)\n  install(DIRECTORY ${name} DESTINATION share/my_bot)\nendforeach()", ""),
        ("include(cmake/installed.cmake)", ""),
    ],
)  # fmt: skip
def test_launch_files_are_installed(tmp_path: Path, line: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", "ament_python", "ament_cmake").remove("setup.py")
    files.put("CMakeLists.txt", CMAKE.format(f"{line}\n")).put("src/there.cpp", "int main() {}\n")
    found = [f for f in of_workspace(files.write(tmp_path)) if f.code == "not-in-data-files"]
    assert [fix in finding.fix and "ament_package" in finding.fix for finding in found] == [True] * bool(fix)
