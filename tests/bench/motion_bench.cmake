cnc_bench(motion_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/motion_bench.cpp" LINKS cnc_motion)
find_package(fmt REQUIRED)
cnc_bench(path_bench SOURCES path_bench.cpp ../motion/path_judge.cpp
          LINKS cnc_interpreter cnc_motion fmt::fmt)
target_include_directories(path_bench PRIVATE "${CMAKE_BINARY_DIR}/rooms/tests")
