#include "workers.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "judge.hpp"

namespace bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A process that sleeps takes no processor time: it is ended after this many limits of silence.
constexpr int silences = 20;
/// What a verdict is sent as: its scene drawn, solved, judged.
constexpr char drawn = 'd', solved = 's', judged = 'j';

void send(int pipe, char stage, const Verdict& verdict) {
  const std::string line = stage + to_line(verdict) + '\n';
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t count = ::write(pipe, line.data() + sent, line.size() - sent);
    if (count <= 0) ::_exit(1);
    sent += static_cast<std::size_t>(count);
  }
}

/// SIGPROF ends the process when the time is over.
void set_limit(int seconds) {
  const itimerval timer{.it_interval = {0, 0}, .it_value = {seconds, 0}};
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

[[noreturn]] void work(const Campaign& campaign, std::uint64_t first, int pipe) {
  const std::string scratch = fs::temp_directory_path() / fmt::format("never-wrong-{}.toml", ::getpid());
  for (std::uint64_t index = first; index < campaign.first + campaign.scenes; index += campaign.jobs) {
    Verdict verdict{.seed = campaign.seed, .index = index};
    set_limit(campaign.limit);
    try {
      verdict.scene = campaign.kept.empty() ? random_scene(campaign.seed, index, campaign.only, scratch)
                                            : read_scene_file(campaign.kept[index]);
      send(pipe, drawn, verdict);
      judge(verdict, scratch, [&] { send(pipe, solved, verdict); });
    } catch (const std::exception& e) {
      verdict.status = "exception";
      verdict.faults.push_back({"exception", fmt::format("no scene was drawn: {}", e.what())});
    }
    send(pipe, judged, verdict);
  }
  std::error_code ignored;
  fs::remove(scratch, ignored);
  ::_exit(0);
}

/// A process and what it last said.
class Worker {
 public:
  Worker(const Campaign& campaign, std::uint64_t first) : campaign_(campaign), next_(first) { start(); }

  int pipe() const { return pipe_; }
  bool finished() const { return pipe_ < 0; }
  bool silent() const { return Clock::now() - heard_ > std::chrono::seconds(silences) * campaign_.limit; }
  void end() const { ::kill(process_, SIGKILL); }

  /// Reads what there is; starts again after the scene that ended the process.
  void listen(const std::function<void(const Verdict&)>& report) {
    char buffer[1 << 16];
    const ssize_t count = ::read(pipe_, buffer, sizeof buffer);
    heard_ = Clock::now();
    if (count > 0) {
      said_.append(buffer, static_cast<std::size_t>(count));
      for (std::size_t end; (end = said_.find('\n')) != std::string::npos; said_.erase(0, end + 1))
        take(said_.substr(0, end), report);
      return;
    }
    ::close(pipe_);
    pipe_ = -1;
    int state = 0;
    ::waitpid(process_, &state, 0);
    if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return;
    report(died(state));
    advance();
    if (next_ < campaign_.first + campaign_.scenes) start();
  }

 private:
  void start() {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
    process_ = ::fork();
    if (process_ < 0) throw std::runtime_error(fmt::format("no process: {}", std::strerror(errno)));
    if (process_ == 0) {
      ::close(ends[0]);
      work(campaign_, next_, ends[1]);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    said_.clear();
    heard_ = Clock::now();
  }

  void advance() {
    next_ += campaign_.jobs;
    stage_ = 0;
  }

  void take(const std::string& line, const std::function<void(const Verdict&)>& report) {
    stage_ = line.front();
    verdict_ = from_line(line.substr(1));
    if (stage_ != judged) return;
    report(verdict_);
    advance();
  }

  Verdict died(int state) const {
    Verdict verdict = stage_ ? verdict_ : Verdict{.seed = campaign_.seed, .index = next_};
    const int number = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    const bool hung = number == SIGPROF || number == SIGKILL;
    const char* const when = stage_ == solved ? "while it was verified"
                             : stage_         ? "while it was solved"
                                              : "while it was drawn";
    if (hung && stage_ == solved)
      verdict.faults.push_back({"unverified", fmt::format("not verified within {} s", campaign_.limit)});
    else
      verdict.faults.push_back(
          {hung ? "hang" : "crash", fmt::format("{} {}", number ? ::strsignal(number) : "exit", when)});
    if (stage_ != solved) verdict.status = hung ? "hang" : "crash";
    return verdict;
  }

  const Campaign& campaign_;
  std::uint64_t next_;
  char stage_ = 0;  ///< of the scene next_; 0: nothing was heard of it
  Verdict verdict_;
  pid_t process_ = -1;
  int pipe_ = -1;
  std::string said_;
  Clock::time_point heard_;
};

}  // namespace

void run_campaign(const Campaign& campaign, const std::function<void(const Verdict&)>& report) {
  std::vector<Worker> workers;
  workers.reserve(campaign.jobs);
  for (int j = 0; j < campaign.jobs && static_cast<std::uint64_t>(j) < campaign.scenes; ++j)
    workers.emplace_back(campaign, campaign.first + j);
  while (true) {
    std::vector<pollfd> waiting;
    std::vector<Worker*> listened;
    for (Worker& worker : workers) {
      if (worker.finished()) continue;
      waiting.push_back({.fd = worker.pipe(), .events = POLLIN, .revents = 0});
      listened.push_back(&worker);
    }
    if (waiting.empty()) return;
    ::poll(waiting.data(), waiting.size(), 1000);
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      if (waiting[k].revents)
        listened[k]->listen(report);
      else if (listened[k]->silent())
        listened[k]->end();
    }
  }
}

}  // namespace bench
