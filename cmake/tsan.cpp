// Part of every program of a ThreadSanitizer build, and of no other: what the sanitizer must know
// of libraries that are not instrumented. Nothing of our own code is left out.
#include <algorithm>
#include <memory>
#include <thread>
#include <vector>

#include <opencv2/core/parallel/parallel_backend.hpp>

// What libraries do by themselves is not looked at. Two reports come without that, both false:
// cv::Mat counts who uses a picture inside OpenCV, so that the thread that frees it seems to race
// with those that read it before; and GDAL, which OpenCV's PNG writer brings along, takes its locks
// in both orders, on one thread.
extern "C" const char* __tsan_default_options() {
  return "ignore_noninstrumented_modules=1 second_deadlock_stack=1";
}

// Embree builds a scene on TBB's threads, of which the same is true; std::string's functions, which
// it calls, are those of our program, and so looked at all the same.
extern "C" const char* __tsan_default_suppressions() { return "race:libembree3.so"; }

namespace {

thread_local int number_in_loop = 0;

// OpenCV hands the work of cv::parallel_for_ to TBB. The sanitizer does not see that TBB's threads
// begin after the call and end before it returns, and takes every loop body of ours for a race.
// These threads it does see, so that the bodies are checked.
class SeenThreads final : public cv::parallel::ParallelForAPI {
 public:
  void parallel_for(int tasks, FN_parallel_for_body_cb_t body, void* data) override {
    // OpenCV never comes here from two threads at once, nor from within a loop.
    const int count = std::min(threads_, tasks);
    const auto share = [&](int i) {
      number_in_loop = i;
      body(i * tasks / count, (i + 1) * tasks / count, data);
    };
    std::vector<std::thread> others;
    for (int i = 1; i < count; ++i) others.emplace_back(share, i);
    if (count > 0) share(0);
    for (std::thread& t : others) t.join();
  }
  int getThreadNum() const override { return number_in_loop; }
  int getNumThreads() const override { return threads_; }
  int setNumThreads(int threads) override {
    const int before = threads_;
    // Also on a machine of one core: two threads may race there as well.
    threads_ = std::max(threads, 2);
    return before;
  }
  const char* getName() const override { return "threads that ThreadSanitizer sees"; }

 private:
  int threads_ = 3;
};

const bool in_use = [] {
  cv::parallel::setParallelForBackend(std::make_shared<SeenThreads>(), false);
  return true;
}();

}  // namespace
