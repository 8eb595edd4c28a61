# What status subscribers cost the link thread, and how much faster than the machine the simulator is.
if(CNC_SERVER)
  cnc_bench(status_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/status_bench.cpp"
            LINKS cnc_test_process cncapi fmt::fmt)
  add_dependencies(status_bench cncserver)
endif()

# How soon a feed hold acts.
cnc_bench(replan_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/replan_bench.cpp" LINKS cnc_server fmt::fmt)

# How fast the time of a job is predicted.
cnc_bench(predict_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/predict_bench.cpp" LINKS cnc_server fmt::fmt)
target_include_directories(predict_bench PRIVATE "${CMAKE_BINARY_DIR}/rooms/tests")

# The link under load: how low the FIFO falls, and how soon a feed hold acts.
if(CNC_SERVER)
  cnc_bench(link_bench SOURCES "${CMAKE_CURRENT_LIST_DIR}/link_bench.cpp" "${CMAKE_CURRENT_LIST_DIR}/link_tap.cpp"
            LINKS cnc_test_process cncapi cnc_hal fmt::fmt)
  add_dependencies(link_bench cncserver cpu5sim)
endif()
