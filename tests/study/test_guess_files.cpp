#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "scenes.hpp"
#include "study/files/numpy.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// The restricted three-body problem of Earth and Moon as JPL has it.
const std::string lyapunov =
    "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nparameters = { mu = 0.01215058560962404 }\n"
    "lagrangian = \"((x' - y)^2 + (y' + x)^2 + z'^2)/2 + (1 - mu)/sqrt((x + mu)^2 + y^2 + z^2) + "
    "mu/sqrt((x - 1 + mu)^2 + y^2 + z^2)\"\n"
    "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = -1.57500841640456\n"  // -C/2
    "[guess]\n";

/// Of the catalogue: L1, Lyapunov, C = 3.15001683280912 (ssd-api.jpl.nasa.gov). The period is rounded.
constexpr double x0 = 0.81596252146384562, vy0 = 0.20722124749217649;
const std::string rows[] = {"0.83,0,0,0,0.1,0,3.17,2.7,1",
                            "0.81596252146384562,0,0,0,0.20722124749217649,0,3.15001683280912,2.84,938"};

void expect_lyapunov(const Study& study) {
  const Solution solution = run(study);
  ASSERT_TRUE(solution.converged()) << solution.message;
  std::vector<double> q(3), v(3);
  solution.trajectory.at(0, q, v);
  EXPECT_NEAR(q[0], x0, 1e-9);
  EXPECT_NEAR(v[1], vy0, 1e-8);
}

/// Bytes of a file .npy, as NumPy's documentation of the format describes them.
template <class Number>
std::string npy(const std::string& type, const std::string& order, const std::string& shape,
                const std::vector<Number>& values) {
  std::string literal =
      "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string bytes("\x93NUMPY\1\0", 8);
  bytes += static_cast<char>(literal.size());
  bytes += '\0';
  bytes += literal;
  return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
}

}  // namespace

TEST_F(Scenes, GuessFromAnOrbitOfJplInJson) {
  const auto quoted = [](std::string row) {
    std::string result = "[\"";
    for (const char c : row) result += c == ',' ? std::string("\",\"") : std::string(1, c);
    return result + "\"]";
  };
  write("orbits.json",
        "{\"signature\": {\"version\": \"1.0\"}, \"fields\": [\"x\", \"y\", \"z\", \"vx\", \"vy\", \"vz\", "
        "\"jacobi\", \"period\", \"stability\"], \"data\": [" +
            quoted(rows[0]) + ", " + quoted(rows[1]) + "]}");
  const std::string scene = lyapunov + "file = \"orbits.json\"\n";
  expect_lyapunov(study(scene + "orbit = 2\n"));
  EXPECT_EQ(study(scene + "orbit = 2\n").problem.duration.value, 2.84);
  EXPECT_EQ(study(scene + "orbit = 2\nduration = 2.9\n").problem.duration.value, 2.9);
  EXPECT_EQ(message(scene), "orbits.json: the file has 2 orbits; say which in [guess], as orbit = 1");
  EXPECT_EQ(message(scene + "orbit = 3\n"),
            "scene.toml:11:9: orbit = 3; 'orbits.json' has the orbits 1 to 2");
  write("orbits.json", "{\"fields\": [\"x\", \"y\", \"z\", \"vx\", \"vy\"], \"data\": [[1, 2, 3, 4, 5]]}");
  EXPECT_EQ(message(scene), "orbits.json: the file has no column 'z''; it has x, y, z, vx, vy");
  write("orbits.json", "{\"fields\": [\"x\", \"y\", \"z\", \"vx\", \"vy\", \"vz\"], \"data\": [[1, 2, 3]]}");
  EXPECT_EQ(message(scene), "orbits.json: an orbit must be a list of 6 values");
  write("orbits.json",
        "{\"fields\": [\"x\", \"y\", \"z\", \"vx\", \"vy\", \"vz\"], \"data\": [[1, 0, 0, 0, null, 0]]}");
  EXPECT_EQ(message(scene), "orbits.json: 'vy' of an orbit is not a finite number");
  write("orbits.json",
        "{\"fields\": [\"x\", \"y\", \"z\", \"vx\", \"vy\", \"vz\"], \"data\": [[0.8, 0, 0, 0, 0.1, 0]]}");
  EXPECT_EQ(message(scene),
            "scene.toml:10:8: this file does not tell a duration; give 'duration' in [guess]");
}

/// Of a search and of a branch, as they are written.
TEST_F(Scenes, GuessFromOneOfSeveralPaths) {
  const std::string scene =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 0 }\nend = { x = "
      "0 "
      "}\nduration = 2\n[guess]\nfile = \"paths.";
  const auto expect_rows = [&](const std::string& ending) {
    EXPECT_EQ(guessed(study(scene + ending + "\"\norbit = 1\n"), 0.5, 0), 1);
    EXPECT_EQ(guessed(study(scene + ending + "\"\norbit = 2\n"), 0.5, 0), -3);
    for (const std::string orbit : {"0", "3", "99"})
      EXPECT_EQ(message(scene + ending + "\"\norbit = " + orbit + "\n"),
                "scene.toml:10:9: orbit = " + orbit + "; 'paths." + ending + "' has the orbits 1 to 2");
  };
  const std::string first = R"("samples": {"t": [0, 1, 2], "x": [0, 1, 0]})",
                    second = R"("samples": {"t": [0, 1, 2], "x": [0, -3, 0]})";
  write("paths.json", "{" + first + ", \"solutions\": [{" + first + "}, {" + second + "}]}");
  expect_rows("json");
  EXPECT_EQ(guessed(study(scene + "json\"\n"), 0.5, 0), 1);  // the file is the result of its first solution
  write("paths.csv", "solution,t,x\n1,0,0\n1,1,1\n1,2,0\n2,0,0\n2,1,-3\n2,2,0\n");
  expect_rows("csv");
  EXPECT_EQ(message(scene + "csv\"\n"),
            "paths.csv: the file has 2 orbits; say which in [guess], as orbit = 1");
  write("paths.json", "{\"points\": [{" + first + "}, {" + second + "}]}");
  expect_rows("json");
  EXPECT_EQ(message(scene + "json\"\n"),
            "paths.json: the file has 2 orbits; say which in [guess], as orbit = 1");
  write("paths.json", "{\"points\": [{\"start\": {\"x\": 0}}]}");
  EXPECT_EQ(message(scene + "json\"\n"),
            "paths.json: the file has no samples; write it with --samples 201 to have some");
  write("paths.csv", "t,x\n0,0\n1,1\n2,0\n");
  EXPECT_EQ(guessed(study(scene + "csv\"\norbit = 1\n"), 0.5, 0), 1);
  EXPECT_EQ(message(scene + "csv\"\norbit = 2\n"),
            "scene.toml:10:9: orbit = 2; 'paths.csv' has one orbit; leave 'orbit' out");
}

TEST_F(Scenes, GuessFromARowOfATable) {
  write("orbits.csv",
        "Id ,x0 (LU),y0 (LU),z0 (LU),vx0 (LU/TU),vy0 (LU/TU),vz0 (LU/TU),\"Jacobi constant (LU2/TU2)\","
        "Period (TU),Stability index\n1," +
            rows[0] + "\n2," + rows[1] + "\n");
  const std::string scene = lyapunov + "file = \"orbits.csv\"\norbit = 2\n";
  expect_lyapunov(study(scene));
  write("orbits.csv", "x,y,z,x',y',z',period\n0.8,0,0,0,oops,0,2.8\n");
  EXPECT_EQ(message(lyapunov + "file = \"orbits.csv\"\n"), "orbits.csv:2:11: 'oops' is not a finite number");
  write("orbits.csv", "x,y,z,x',y',z',period\n0.8,0,0,0,0.1,0,-2.8\n");
  EXPECT_EQ(message(lyapunov + "file = \"orbits.csv\"\n"),
            "orbits.csv: the period is -2.8; it must be positive");
  EXPECT_EQ(message(lyapunov + "x = 1\norbit = 2\n"),
            "scene.toml:11:1: 'orbit' needs 'file': it chooses an orbit of a file");
}

/// Spreadsheets write a byte order mark in front of UTF-8.
TEST_F(Scenes, GuessFromATableWithAByteOrderMark) {
  write("path.csv", "\xEF\xBB\xBFt,x\n0,1\n1,3\n2,5\n");
  const Study from_file = study(
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2\"\n[boundary]\nstart = { x = 1 }\nend = { x = "
      "5 }\n"
      "duration = 2\n[guess]\nfile = \"path.csv\"\n");
  EXPECT_EQ(guessed(from_file, 0.5, 0), 3);
}

TEST_F(Scenes, GuessFromAutosSolutions) {
  // Two solutions of x' = v, v' = -x with three parameters of their own and a fourth place for the period.
  const auto solution = [](int label, double period) {
    std::string text = "     1    10     9   " + std::to_string(label) +
                       "     2     1     5     3    24     2     2    11     0     2     2     0\n";
    for (int k = 0; k <= 4; ++k) {
      char line[200];
      std::snprintf(line, sizeof line, "   %.10E   %.10E\n     %.10E\n", k / 4.0,
                    label * std::cos(2 * M_PI * k / 4), -label * std::sin(2 * M_PI * k / 4));
      text += line;
    }
    text += "    1   11\n   0.1000000000E+01   0.0000000000E+00\n";
    for (int k = 0; k <= 4; ++k) text += "   0.1D+00   0.25-100\n";
    text += "   1.0 2.0 3.0 4.0 5.0 6.0 7.0\n   8.0 9.0 10.0 " + std::to_string(period) + "\n";
    for (int k = 0; k < 5; ++k) text += "   0.0\n";
    return text;
  };
  write("fort.8", solution(3, 6.25) + solution(7, 6.5));
  const std::string oscillator =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - x^2/2 - x^4/100\"\n[boundary]\nperiodic = "
      "true\nduration = \"free\"\nenergy = 20\n[guess]\nfile = \"fort.8\"\n";
  const Study s = study(oscillator + "orbit = 7\n");
  EXPECT_EQ(s.problem.duration.value, 6.5);
  EXPECT_EQ(guessed(s, 0, 0), 7);
  EXPECT_NEAR(guessed(s, 0.25, 0), 0, 1e-9);
  EXPECT_EQ(guessed(study(oscillator + "orbit = 3\n"), 0.5, 0), -3);
  EXPECT_EQ(message(oscillator),
            "fort.8: the file has the solutions 3, 7; say which in [guess], as orbit = 3");
  EXPECT_EQ(message(oscillator + "orbit = 4\n"),
            "scene.toml:10:9: orbit = 4; 'fort.8' has the solutions 3, 7");
  write("fort.8", solution(3, 6.25).substr(0, 300));
  EXPECT_EQ(message(oscillator).rfind("fort.8:", 0), 0u);
  EXPECT_NE(message(oscillator).find("ends within a solution"), std::string::npos) << message(oscillator);
  std::string standing = solution(3, 6.25);
  write("fort.8", standing.replace(standing.find("2.5000000000E-01"), 16, "0.0000000000E+00"));
  EXPECT_EQ(message(oscillator),
            "fort.8:1:1: the times must increase; found 0 after 0; order the rows by t, one path a file");
  write("fort.8", "1 1 1 1 1 1 -5 3 4 5 6\n");
  EXPECT_EQ(message(oscillator), "fort.8:1:1: the numbers of points, columns and lines cannot be negative");
  write("fort.8", "1 1 1 1 1 1 5 1 4 5 6\n");
  EXPECT_EQ(message(oscillator), "fort.8:1:1: solution 1 has 0 variables; the scene has 1 coordinates");
}

TEST_F(Scenes, GuessFromLoopsOfBodies) {
  constexpr int samples = 48;
  std::vector<double> loop;
  for (int k = 0; k < samples; ++k) loop.push_back(std::cos(2 * M_PI * k / samples));
  for (int k = 0; k < samples; ++k) loop.push_back(std::sin(4 * M_PI * k / samples) / 3);
  write("eight.npy", npy<double>("<f8", "False", "(1, 2, 48)", loop));
  // The second body is a third behind the first; the third runs along the loop turned by 90 degrees,
  // backwards.
  write("eight.json",
        R"({"nbody": 3, "Targets": [[0, 1, 2]], "TimeRevsUn": [[1, 1, -1]], "TimeShiftNumUn": [[0, 1, 1]],
            "TimeShiftDenUn": [[1, 3, 4]],
            "SpaceRotsUn": [[[[1, 0], [0, 1]], [[1, 0], [0, 1]], [[0, -1], [1, 0]]]]})");
  const std::string scene =
      "[system]\ncoordinates = [\"x[3]\", \"y[3]\"]\nlagrangian = \"sum(i, 1, 3, x[i]'^2 + y[i]'^2)/2 + "
      "sum(i, 1, 2, sum(j, i + 1, 3, 1/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2)))\"\n[boundary]\nperiodic = "
      "true\nduration = 1\n[guess]\nfile = \"eight.npy\"\n";
  const Study s = study(scene);
  const auto x = [](double t) { return std::cos(2 * M_PI * t); };
  const auto y = [](double t) { return std::sin(4 * M_PI * t) / 3; };
  for (const double t : {0.0, 0.25, 0.75, 1.0}) {
    EXPECT_NEAR(guessed(s, t, 0), x(t), 1e-12);
    EXPECT_NEAR(guessed(s, t, 1), x(t - 1.0 / 3), 1e-12);
    EXPECT_NEAR(guessed(s, t, 2), -y(0.25 - t), 1e-12);
    EXPECT_NEAR(guessed(s, t, 4), y(t - 1.0 / 3), 1e-12);
    EXPECT_NEAR(guessed(s, t, 5), x(0.25 - t), 1e-12);
  }
  write(
      "eight.json",
      R"({"nbody": 1, "Targets": [[0]], "TimeRevsUn": [[1]], "TimeShiftNumUn": [[1]], "TimeShiftDenUn": [[0]],
            "SpaceRotsUn": [[[[1, 0], [0, 1]]]]})");
  EXPECT_NE(message(scene).find("a shift in time is not finite"), std::string::npos) << message(scene);
  write("eight.json", "{\"nbody\": 3}");
  EXPECT_EQ(message(scene).rfind("eight.json: this does not describe loops of bodies", 0), 0u);
  write("three.npy", npy<double>("<f8", "False", "(3, 2, 2)", std::vector<double>(12, 1.0)));
  EXPECT_EQ(
      message(lyapunov + "duration = 1\nfile = \"three.npy\"\n"),
      "three.npy: the file has 3 bodies; coordinates for it are arrays, one a dimension, as \"x[3]\" and "
      "\"y[3]\"");
  write("flat.npy", npy<double>("<f8", "False", "(4,)", {1, 2, 3, 4}));
  EXPECT_EQ(message(lyapunov + "duration = 1\nfile = \"flat.npy\"\n"),
            "flat.npy: the array has 1 dimensions; loops have the shape (bodies, dimension, samples)");
}

TEST_F(Scenes, GuessFromArrays) {
  const std::vector<double> t{0, 0.5, 2}, x{1, 2, 3}, y{0, 1, 0}, z{0, 0, 0};
  write("path.npz", npz({{"t", t}, {"x", x}, {"y", y}, {"z", z}, {"x'", y}}));
  const Study s = study(lyapunov + "file = \"path.npz\"\n");
  EXPECT_EQ(s.problem.guess.tau, (std::vector<double>{0, 0.25, 1}));
  EXPECT_EQ(s.problem.duration.value, 2);
  EXPECT_EQ(guessed(s, 0.25, 0), 2);
  write("path.npz", npz({{"t", t}, {"x", x}}));
  EXPECT_EQ(message(lyapunov + "file = \"path.npz\"\n"), "path.npz: the file has no array 'y'");
  write("path.npz", npz({{"t", t}, {"x", x}, {"y", y}, {"z", {}}}));
  EXPECT_EQ(message(lyapunov + "file = \"path.npz\"\n"),
            "path.npz: the samples have 3 times and 0 values of 'z'");
  std::string damaged = npz({{"t", t}, {"x", x}, {"y", y}, {"z", z}});
  damaged.resize(damaged.size() / 2);
  write("path.npz", damaged);
  EXPECT_EQ(message(lyapunov + "file = \"path.npz\"\n"), "path.npz: this is no archive");
}

TEST(Numpy, ReadsWhatItIsGiven) {
  const std::array<double, 6> rows{1, 2, 3, 4, 5, 6};
  const std::vector<float> columns{1, 4, 2, 5, 3, 6};
  const NumpyArray a = read_npy(npy<float>("<f4", "True", "(2, 3)", columns));
  EXPECT_EQ(a.shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_TRUE(std::equal(rows.begin(), rows.end(), a.values.begin(), a.values.end()));
  EXPECT_EQ(read_npy(npy<std::int64_t>("<i8", "False", "(2,)", {-7, 8})).values,
            (std::vector<double>{-7, 8}));
  EXPECT_EQ(read_npy(npy<std::int32_t>("<i4", "False", "()", {9})).values, (std::vector<double>{9}));
  const auto refusal = [](const std::string& bytes) {
    try {
      read_npy(bytes);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("no array at all"), "this is no array of NumPy");
  EXPECT_EQ(refusal(npy<double>("<f8", "False", "(3,)", {1, 2})),
            "it has 16 bytes of values, which its shape contradicts");
  EXPECT_EQ(refusal(npy<double>("<f8", "False", "(4294967296, 4294967296)", {1, 2})),
            "it has 16 bytes of values, which its shape contradicts");
  EXPECT_EQ(refusal(npy<double>("<c16", "False", "(1,)", {1, 2})),
            "it has values of type '<c16'; save real numbers of 8 bytes, as array.astype('<f8') gives");
  EXPECT_EQ(refusal(npy<double>("<f8", "False", "2", {1, 2})), "its shape is damaged");
  const std::string text = "{'fortran_order': False, 'shape': (1,), 'descr':";
  const std::string before = std::string("\x93NUMPY\1\0", 8) + static_cast<char>(text.size()) + '\0';
  EXPECT_EQ(refusal(before + text + std::string(8, '0')), "it has values that are no plain numbers");
  const std::string whole = npy<double>("<f8", "False", "(2,)", {1, 2});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
}

TEST(Numpy, ArchivesAreReadBack) {
  const std::vector<double> many(1000, 0.1), none;
  const std::string bytes = npz({{"many", many}, {"none", none}, {"x[1]'", many}});
  const auto arrays = read_npz(bytes, bytes.size());
  ASSERT_EQ(arrays.size(), 3u);
  EXPECT_EQ(arrays.at("x[1]'").values, many);
  EXPECT_TRUE(arrays.at("none").values.empty());
  EXPECT_EQ(bytes, npz({{"many", many}, {"none", none}, {"x[1]'", many}}));
  EXPECT_THROW(read_npz(bytes, 8000), std::runtime_error);
}
