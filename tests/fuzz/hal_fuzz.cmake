cnc_fuzz(hal_fuzz "${CMAKE_CURRENT_LIST_DIR}/hal_fuzz.cpp" cnc_hal)
cnc_fuzz(scenario_fuzz "${CMAKE_CURRENT_LIST_DIR}/scenario_fuzz.cpp" cnc_hal)
cnc_fuzz(wire_fuzz "${CMAKE_CURRENT_LIST_DIR}/wire_fuzz.cpp" cnc_hal)
