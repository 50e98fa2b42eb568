find_package(Ceres REQUIRED)
target_link_libraries(${target} PRIVATE Ceres::ceres)
