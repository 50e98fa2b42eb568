find_package(CLI11 REQUIRED)
target_link_libraries(extremal_app PRIVATE CLI11::CLI11)
