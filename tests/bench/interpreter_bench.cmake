find_package(fmt REQUIRED)
cnc_bench(interpreter_bench SOURCES interpreter_bench.cpp LINKS cnc_interpreter fmt::fmt)
