# Toolchain: 64-bit Arm by Debian's cross compiler, programs run by qemu-user. EXTREMAL_ARM_ROOT holds the libraries
# for Arm (.ci/arm fills it).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES EXTREMAL_ARM_ROOT)
set(CMAKE_FIND_ROOT_PATH ${EXTREMAL_ARM_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CXX_FLAGS_INIT "-isystem ${EXTREMAL_ARM_ROOT}/usr/include -isystem ${EXTREMAL_ARM_ROOT}/usr/include/aarch64-linux-gnu")
set(libraries ${EXTREMAL_ARM_ROOT}/usr/lib/aarch64-linux-gnu)
string(CONCAT CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,${libraries}"
       ":${libraries}/blas:${libraries}/lapack")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /usr/aarch64-linux-gnu
    -E LD_LIBRARY_PATH=${libraries}:${libraries}/blas:${libraries}/lapack)
