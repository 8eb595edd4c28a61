cnc_bench(hal_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/hal_bench.cpp" LINKS cnc_hal)
