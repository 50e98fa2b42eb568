target_link_libraries(${target} PUBLIC ${SLEEF_LIBRARY} Threads::Threads)
