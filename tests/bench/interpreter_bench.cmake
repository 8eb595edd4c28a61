find_package(fmt REQUIRED)
cnc_bench(interpreter_bench SOURCES interpreter_bench.cpp interpreter_programs.cpp
          LINKS cnc_interpreter fmt::fmt)
cnc_bench(large_file_bench SOURCES large_file_bench.cpp LINKS cnc_interpreter fmt::fmt)
