# Installs BINARY_DIR below WORK_DIR, builds the consumer SOURCE_DIR against it and compares what it prints.
# cmake -DBINARY_DIR=… -DWORK_DIR=… -DSOURCE_DIR=… -DCOMPILER=… -DFLAGS=… -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G Ninja -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/consumer)
# The initial velocity of the Kepler arc (1, 0) → (−0.6, 0.9) in 2.5, rounded from 0.0986855516302332 and
# 0.9978231699793557 (shooting in 113-bit arithmetic).
if(NOT output STREQUAL "velocity 0.098685552 0.997823170\n")
  message(FATAL_ERROR "the consumer printed: ${output}")
endif()
