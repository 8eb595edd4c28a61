find_package(fmt REQUIRED)
# The moves of a file, for the planner.
add_library(cnc_path_program STATIC path_program.cpp)
target_link_libraries(cnc_path_program PUBLIC cnc_interpreter cnc_motion fmt::fmt)
target_include_directories(cnc_path_program PUBLIC "${CMAKE_BINARY_DIR}/rooms/tests")
target_compile_options(cnc_path_program PRIVATE ${CNC_WARNINGS})

cnc_bench(motion_bench SOURCES motion_bench.cpp ../motion/time_bound.cpp LINKS cnc_path_program)
cnc_bench(path_bench SOURCES path_bench.cpp ../motion/path_judge.cpp LINKS cnc_path_program)
cnc_bench(jerk_bench SOURCES jerk_bench.cpp LINKS cnc_path_program)
cnc_bench(motion_soak
  SOURCES motion_soak.cpp ../motion/path_judge.cpp ../motion/program_judge.cpp ../motion/program_text.cpp ../motion/random_program.cpp
  LINKS cnc_motion)
target_include_directories(motion_soak PRIVATE "${CMAKE_BINARY_DIR}/rooms/tests")
cnc_bench(planner_pictures SOURCES planner_pictures.cpp svg.cpp ../motion/time_bound.cpp
          LINKS cnc_path_program)
