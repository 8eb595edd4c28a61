foreach(name hal_fuzz scenario_fuzz trace_fuzz wire_board_fuzz wire_host_fuzz)
  cnc_fuzz(${name} "${CMAKE_CURRENT_LIST_DIR}/${name}.cpp" cnc_hal)
endforeach()
