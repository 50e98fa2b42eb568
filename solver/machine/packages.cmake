target_link_libraries(${target} PUBLIC sleef::sleef Threads::Threads)
