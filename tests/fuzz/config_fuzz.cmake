cnc_fuzz(config_fuzz config_fuzz.cpp cnc_config)
