"""The file of CMake: the library and the test that it makes, by CMake itself; and C++ beside it."""

import pytest

from tests.exporters.programs import built, compiler, run, source_file, write_formats

PROJECT = source_file("CMakeLists.txt")
MAIN = source_file("robot.cpp")


@pytest.fixture
def firmware(sampled_export, tmp_path):
    (tmp_path / "firmware").mkdir()
    (tmp_path / "main.cpp").write_text(MAIN)
    formats = ("c", "monitor", "cmake")
    return write_formats(tmp_path / "firmware", sampled_export, formats)


def test_a_program_in_cpp_calls_the_law(firmware, tmp_path):
    """Its headers say that the functions are C, and C++ has no word against them."""
    strict = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wold-style-cast", "-I", firmware)
    built(compiler("g++"), "-std=c++11", *strict, "-c", tmp_path / "main.cpp", "-o", tmp_path / "o")
    law, monitor = (firmware / f"soft-tissue{end}.c" for end in ("", "_monitor"))
    for source in (law, monitor):
        built(compiler("gcc"), "-c", source, "-o", source.with_suffix(".o"))
    objects = [source.with_suffix(".o") for source in (law, monitor)]
    built(compiler("g++"), tmp_path / "o", *objects, "-o", tmp_path / "robot")
    assert run(tmp_path / "robot").returncode == 0


def test_cmake_builds_the_library_and_runs_its_test(firmware, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(PROJECT)
    build = tmp_path / "build"
    # What the project wants to be fast does not reach the law.
    flags = "-DCMAKE_C_FLAGS=-O3 -march=haswell -ffp-contract=fast"
    for command in (("-S", tmp_path, "-B", build, flags), ("--build", build)):
        done = run(compiler("cmake"), *command)
        assert done.returncode == 0, done.stdout + done.stderr
    assert run(build / "robot").returncode == 0
    tested = run(compiler("ctest"), "--test-dir", build)
    # Versions of CTest write the rest of the line in their own ways.
    assert tested.returncode == 0, tested.stdout
    assert "100% tests passed" in tested.stdout
    assert "No tests were found" not in tested.stderr


def test_without_a_self_test_there_is_no_test(firmware, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(PROJECT)
    for file in firmware.glob("*_test.*"):
        file.unlink()
    assert run(compiler("cmake"), "-S", tmp_path, "-B", tmp_path / "build").returncode == 0
    assert "No tests were found" in run(compiler("ctest"), "--test-dir", tmp_path / "build").stderr
