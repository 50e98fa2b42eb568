target_link_libraries(test_analysis PRIVATE extremal)
# Published orbits and scenes of bench/data are read as in solve/.
target_sources(test_analysis PRIVATE solve/published.cpp solve/scenes.cpp)
