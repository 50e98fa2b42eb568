extremal_package(Qd)
target_link_libraries(${target} PUBLIC qd::qd)
