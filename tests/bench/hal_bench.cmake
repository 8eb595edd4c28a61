cnc_bench(hal_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/hal_bench.cpp" LINKS cnc_hal)
cnc_bench(pulse_soak SOURCES "${CMAKE_CURRENT_LIST_DIR}/pulse_soak.cpp" LINKS cnc_hal)
target_include_directories(pulse_soak PRIVATE "${CMAKE_BINARY_DIR}/rooms/tests")
