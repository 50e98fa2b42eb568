# What an installation holds: the libraries, their headers, the command with its manual page and completion,
# the problems, and a package for find_package(extremal). EXTREMAL_PACKAGES, filled beside the folders, are the
# packages that the exported targets name.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/extremal)
set(EXTREMAL_PROBLEMS_DIR ${CMAKE_INSTALL_DATADIR}/extremal/problems)

install(TARGETS ${EXTREMAL_TARGETS} EXPORT extremalTargets)
# The program prints its manual page and its completion of shells.
if(TARGET extremal_app)
  install(TARGETS extremal_app)
  set(pages ${PROJECT_BINARY_DIR}/pages)
  add_custom_command(OUTPUT ${pages}/extremal.1 ${pages}/extremal ${pages}/_extremal
      COMMAND ${CMAKE_COMMAND} -E make_directory ${pages}
      COMMAND extremal_app man > ${pages}/extremal.1
      COMMAND extremal_app completion bash > ${pages}/extremal
      COMMAND extremal_app completion zsh > ${pages}/_extremal
      DEPENDS extremal_app VERBATIM)
  add_custom_target(extremal_pages ALL DEPENDS ${pages}/extremal.1 ${pages}/extremal ${pages}/_extremal)
  install(FILES ${pages}/extremal.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${pages}/extremal DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${pages}/_extremal DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
endif()
install(DIRECTORY solver/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/extremal
        FILES_MATCHING PATTERN *.hpp PATTERN app EXCLUDE)
install(DIRECTORY problems/ DESTINATION ${EXTREMAL_PROBLEMS_DIR} FILES_MATCHING PATTERN *.toml PATTERN *.csv PATTERN README.md)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/extremal)

get_property(packages GLOBAL PROPERTY EXTREMAL_PACKAGES)
list(REMOVE_DUPLICATES packages)
list(TRANSFORM packages REPLACE "(.+)" "find_dependency(\\1)")
list(JOIN packages "\n" EXTREMAL_DEPENDENCIES)
configure_package_config_file(cmake/extremalConfig.cmake.in extremalConfig.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS EXTREMAL_PROBLEMS_DIR)
write_basic_package_version_file(extremalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(GLOB find_modules cmake/Find*.cmake)
install(FILES ${PROJECT_BINARY_DIR}/extremalConfig.cmake ${PROJECT_BINARY_DIR}/extremalConfigVersion.cmake
        ${find_modules} DESTINATION ${package_dir})
install(EXPORT extremalTargets NAMESPACE extremal:: DESTINATION ${package_dir})

# `make package`: one Debian package of all of it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Extremal <extremal@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox, python3-numpy")
include(CPack)
