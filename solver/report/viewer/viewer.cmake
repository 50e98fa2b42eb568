# The text of interactive pages, page_template.cpp in the build folder: scripts, style and the packages of
# package-lock.json in one, by node. Without npm, or where it cannot have the packages, the program is built
# without pages.
set(EXTREMAL_VIEWER AUTO CACHE STRING "Interactive pages: ON, OFF, or AUTO where npm is at hand")
set_property(CACHE EXTREMAL_VIEWER PROPERTY STRINGS AUTO ON OFF)
set(viewer_source ${CMAKE_CURRENT_LIST_DIR})
set(viewer_build ${PROJECT_BINARY_DIR}/viewer)
file(MAKE_DIRECTORY ${viewer_build})
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${viewer_source}/package-lock.json)

set(viewer_absence "")
if(NOT EXTREMAL_VIEWER)
  set(viewer_absence "this program was built with EXTREMAL_VIEWER=OFF")
else()
  find_program(EXTREMAL_NODE node)
  find_program(EXTREMAL_NPM npm)
  if(NOT EXTREMAL_NODE OR NOT EXTREMAL_NPM)
    set(viewer_absence "this program was built without npm; install Node.js with npm and build again")
  else()
    # Packages are had once for each state of the lock.
    file(SHA256 ${viewer_source}/package-lock.json viewer_lock)
    set(viewer_had "")
    if(EXISTS ${viewer_build}/had.txt)
      file(READ ${viewer_build}/had.txt viewer_had)
    endif()
    if(NOT viewer_had STREQUAL viewer_lock)
      file(COPY ${viewer_source}/package.json ${viewer_source}/package-lock.json ${viewer_source}/.npmrc
           DESTINATION ${viewer_build})
      execute_process(COMMAND ${EXTREMAL_NPM} ci --ignore-scripts --prefer-offline --fetch-retries=1
          --fetch-timeout=20000 WORKING_DIRECTORY ${viewer_build} TIMEOUT 120 RESULT_VARIABLE viewer_failure
          OUTPUT_FILE ${viewer_build}/npm.log ERROR_FILE ${viewer_build}/npm-errors.log)
      if(viewer_failure EQUAL 0)
        file(WRITE ${viewer_build}/had.txt ${viewer_lock})
      else()
        set(viewer_absence "npm could not install the packages of pages; build again where it can")
      endif()
    endif()
  endif()
endif()

set(viewer_template ${viewer_build}/page_template.cpp)
if(viewer_absence)
  if(EXTREMAL_VIEWER STREQUAL "ON")
    message(FATAL_ERROR "EXTREMAL_VIEWER=ON: ${viewer_absence}; see ${viewer_build}/npm-errors.log")
  endif()
  message(STATUS "Interactive pages are left out: ${viewer_absence}")
  configure_file(${viewer_source}/absent.cpp.in ${viewer_template} @ONLY)
else()
  file(GLOB viewer_scripts CONFIGURE_DEPENDS ${viewer_source}/*.js)
  add_custom_command(OUTPUT ${viewer_template}
      COMMAND ${EXTREMAL_NODE} ${viewer_source}/build.mjs ${viewer_build}/node_modules ${viewer_template}
      DEPENDS ${viewer_source}/build.mjs ${viewer_source}/page.html ${viewer_source}/page.css
              ${viewer_scripts} ${viewer_build}/had.txt
      COMMENT "Bundling the pages" VERBATIM)
endif()
target_sources(${target} PRIVATE ${viewer_template})
set_source_files_properties(${viewer_template} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
