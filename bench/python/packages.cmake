find_package(nlohmann_json REQUIRED)
find_program(EXTREMAL_PYTHON_PROGRAM python3 PATHS /usr/bin NO_DEFAULT_PATH)
target_link_libraries(${target} PRIVATE nlohmann_json::nlohmann_json)
target_compile_definitions(${target} PRIVATE EXTREMAL_PYTHON_PROGRAM="${EXTREMAL_PYTHON_PROGRAM}"
                           EXTREMAL_PYTHON_MODULE="${PROJECT_BINARY_DIR}/python")
