# What status subscribers cost the link thread, and how much faster than the machine the simulator is.
if(CNC_SERVER)
  cnc_bench(status_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/status_bench.cpp"
                                 "${CMAKE_CURRENT_LIST_DIR}/../end_to_end/child_process.cpp"
            LINKS cncapi fmt::fmt)
  target_include_directories(status_bench PRIVATE "${CMAKE_BINARY_DIR}/rooms/tests")
  add_dependencies(status_bench cncserver)
endif()
