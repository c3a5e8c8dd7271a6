/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* weft run --watch and weft view --watch as their clients see them. What a browser
 * makes of it is tests/view/browser. */
#include "shell.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <time.h>

#define OUT BUILD_DIR "/watch-test"

#ifndef WEFT_HTTP

START_TEST(a_weft_without_a_server_says_so)
{
    expect(shell(WEFT " run " OUT "/s.yaml --watch 2>&1"), 2);
    says("--watch: this weft was built without libmicrohttpd (package "
         "libmicrohttpd-dev)");
}
END_TEST

TEST_SUITE(watch)
{
    Suite *all = suite_create("watch");
    TCase *none = tcase_create("none");
    tcase_add_test(none, a_weft_without_a_server_says_so);
    suite_add_tcase(all, none);
    return all;
}

#else

/* A weft in the background, and where it serves. */
typedef struct served {
    FILE *pipe;
    pid_t pid;
    int port;
} served;

static served run;

/* 5e8 steps: longer than any test on any machine. */
#define SLOW "--set stepper.fixed_step=1.0e-9 --set run.fps=1e6"

static served start(const char *arguments)
{
    char command[512];
    served made = { .port = 0 };
    (void)snprintf(command, sizeof command, "echo $$; exec " WEFT " %s 2>&1",
                   arguments);
    made.pipe = popen(command, "r");
    ck_assert_ptr_nonnull(made.pipe);
    ck_assert_int_eq(fscanf(made.pipe, "%d", &made.pid), 1);
    (void)getc(made.pipe);
    return made;
}

static served start_server(const char *arguments)
{
    served made = start(arguments);
    ck_assert_ptr_nonnull(fgets(output, sizeof output, made.pipe));
    ck_assert_msg(sscanf(output, "http://127.0.0.1:%d/", &made.port) == 1, "%s",
                  output);
    return made;
}

static int end(const served *of)
{
    output[fread(output, 1, sizeof output - 1, of->pipe)] = '\0';
    const int status = pclose(of->pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void begin(void)
{
    expect(shell("rm -rf " OUT "; mkdir -p " OUT), 0);
    write_file(OUT "/s.yaml", small_scene);
}

static void start_run(const char *more)
{
    char arguments[384];
    (void)snprintf(arguments, sizeof arguments,
                   "run " OUT "/s.yaml --out " OUT "/r --watch --quiet %s", more);
    run = start_server(arguments);
}

static int stop(const served *of, int number)
{
    ck_assert_int_eq(kill(of->pid, number), 0);
    return end(of);
}

static int connect_to(const char *host, int port)
{
    struct sockaddr_in address
        = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port) };
    const int made = socket(AF_INET, SOCK_STREAM, 0);
    ck_assert_int_eq(inet_pton(AF_INET, host, &address.sin_addr), 1);
    if (connect(made, (struct sockaddr *)&address, sizeof address) == 0) {
        return made;
    }
    (void)close(made);
    return -1;
}

static int ask(int port, const char *request, const char *host)
{
    char text[512];
    const int made = connect_to("127.0.0.1", port);
    ck_assert_int_ge(made, 0);
    const int length = snprintf(text, sizeof text,
                                "%s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n",
                                request, host);
    ck_assert_int_eq(send(made, text, (size_t)length, 0), length);
    return made;
}

/* All that is answered goes to `body`; the status code is returned. */
static char body[1 << 21];

static int answer(int client)
{
    size_t used = 0;
    for (ssize_t got;
         (got = recv(client, body + used, sizeof body - 1 - used, 0)) > 0;) {
        used += (size_t)got;
    }
    body[used] = '\0';
    (void)close(client);
    return used > 12 ? atoi(body + 9) : 0;
}

static int get(const char *path)
{
    char request[256], host[32];
    (void)snprintf(request, sizeof request, "GET %s", path);
    (void)snprintf(host, sizeof host, "127.0.0.1:%d", run.port);
    return answer(ask(run.port, request, host));
}

static void wait_for(const char *command)
{
    const struct timespec pause = { .tv_nsec = 20000000 };
    while (shell("%s", command) != 0) {
        (void)nanosleep(&pause, NULL);
    }
}

/* Stops a run that has frames, and says whether it came before the run's result. */
static bool hold(const served *of)
{
    const struct timespec pause = { .tv_nsec = 200000 };
    siginfo_t info = { 0 };
    while (!exists(OUT "/r/run.vtkhdf") && !exists(OUT "/r/result.yaml")) {
        (void)nanosleep(&pause, NULL);
    }
    (void)kill(of->pid, SIGSTOP);
    ck_assert_int_eq(waitid(P_PID, (id_t)of->pid, &info, WSTOPPED | WEXITED | WNOWAIT),
                     0);
    return info.si_code == CLD_STOPPED && !exists(OUT "/r/result.yaml");
}

/* A run that has frames and is held before its end. Where it was quicker, it is begun
 * again with twice as many steps. `step` is that which held [s]. */
static served start_held(const char *arguments, double *step)
{
    char command[384];
    for (;; *step /= 2.0) {
        (void)snprintf(command, sizeof command,
                       "run " OUT "/s.yaml --out " OUT
                       "/r --quiet --set stepper.fixed_step=%.17e %s",
                       *step, arguments);
        (void)shell("rm -rf " OUT "/r");
        const bool serves = strstr(arguments, "--watch") != NULL;
        const served made = serves ? start_server(command) : start(command);
        if (hold(&made)) {
            return made;
        }
        (void)kill(made.pid, SIGKILL);
        (void)end(&made);
    }
}

static void go_on(const served *of)
{
    ck_assert_int_eq(kill(of->pid, SIGCONT), 0);
}

/* Asks for the frames of a run that is held; returns once they are on their way. */
static int ask_frames(const char *path, const char *header)
{
    char request[256], host[128], first;
    (void)snprintf(request, sizeof request, "GET %s", path);
    (void)snprintf(host, sizeof host, "127.0.0.1:%d%s", run.port, header);
    const int client = ask(run.port, request, host);
    ck_assert_int_eq(recv(client, &first, 1, MSG_PEEK), 1);
    return client;
}

START_TEST(the_page_comes_with_a_policy_that_lets_it_ask_its_server_alone)
{
    start_run(SLOW);
    wait_for("test -e " OUT "/r/run.html");
    ck_assert_int_eq(get("/"), 200);
    ck_assert_ptr_nonnull(strstr(body, "connect-src 'self'"));
    ck_assert_ptr_nonnull(strstr(body, "\"live\":{\"frame\":"));
    ck_assert_ptr_nonnull(strstr(body, "Content-Type: text/html; charset=utf-8\r\n"));
    ck_assert_ptr_nonnull(strstr(body, "</html>"));
    expect(shell("grep -c \"connect-src 'none'\" " OUT "/r/run.html"), 0);
    expect(shell("grep -c '\"live\":' " OUT "/r/run.html"), 1);
    expect(stop(&run, SIGTERM), 143);
}
END_TEST

START_TEST(no_other_name_of_this_machine_is_answered)
{
    static const char *const others[]
        = { "evil.example", "evil.example:%d",           "127.0.0.1",
            "127.0.0.1:1",  "localhost:%d.evil.example", "" };
    char host[64];
    start_run(SLOW);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; ++i) {
        const char *mark = strstr(others[i], "%d");
        if (mark == NULL) {
            (void)snprintf(host, sizeof host, "%s", others[i]);
        } else {
            (void)snprintf(host, sizeof host, "%.*s%d%s", (int)(mark - others[i]),
                           others[i], run.port, mark + 2);
        }
        const int code = answer(ask(run.port, "GET /frames", host));
        ck_assert_msg(code == 403 || code == 400, "%s: %d", host, code);
    }
    (void)snprintf(host, sizeof host, "localhost:%d", run.port);
    ck_assert_int_eq(answer(ask(run.port, "GET /x", host)), 404);
    ck_assert_int_lt(connect_to("127.0.0.2", run.port), 0);
    expect(stop(&run, SIGINT), 130);
}
END_TEST

START_TEST(nothing_but_the_page_and_its_frames_is_there)
{
    static const char *const paths[] = { "/series.csv",
                                         "/run.html",
                                         "/../s.yaml",
                                         "/..%2f..%2fetc/passwd",
                                         "//etc/passwd",
                                         "/frames/",
                                         "/frames/../series.csv",
                                         "*" };
    char host[32];
    start_run(SLOW);
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; ++i) {
        const int code = get(paths[i]);
        ck_assert_msg(code == 404 || code == 400, "%s: %d", paths[i], code);
    }
    (void)snprintf(host, sizeof host, "127.0.0.1:%d", run.port);
    ck_assert_int_eq(answer(ask(run.port, "POST /", host)), 405);
    ck_assert_int_eq(answer(ask(run.port, "DELETE /frames", host)), 405);
    expect(stop(&run, SIGTERM), 143);
}
END_TEST

START_TEST(every_frame_comes_with_its_rows_and_then_the_result)
{
    double step = 1e-4;
    run = start_held("--watch", &step);
    const int client = ask_frames("/frames?frame=0&series=0", "");
    go_on(&run);
    ck_assert_int_eq(answer(client), 200);
    expect(end(&run), 0);
    ck_assert_ptr_nonnull(strstr(body, "Content-Type: text/event-stream\r\n"));
    char text[128];
    const char *at = body;
    for (int i = 0; i <= 10; ++i) {
        (void)snprintf(text, sizeof text,
                       "\nid: %d\ndata: {\"index\":%d,\"number\":%d,", i, i, i);
        at = strstr(at, text);
        ck_assert_msg(at != NULL, "no frame %d in:\n%s", i, body);
    }
    ck_assert_ptr_nonnull(strstr(body, "\"series\":\"frame,time,"));
    ck_assert_ptr_nonnull(strstr(body, "10,0.5,"));
    at = strstr(
        at, "\nevent: end\ndata: {\"series\":\"\",\"result\":\"status: done\\u000a");
    ck_assert_msg(at != NULL, "no end in:\n%s", body);
    says("/r/run.html\n");
    expect(shell("grep -c '<script type=\"weft/frame\">' " OUT "/r/run.html"), 0);
    ck_assert_int_eq(atoi(output), 11);
}
END_TEST

START_TEST(a_client_gets_what_it_lacks)
{
    double step = 1e-4;
    run = start_held("--watch", &step);
    const int client = ask_frames("/frames?frame=2&series=0", "\r\nLast-Event-ID: 4");
    go_on(&run);
    ck_assert_int_eq(answer(client), 200);
    ck_assert_ptr_null(strstr(body, "\nid: 4\n"));
    ck_assert_ptr_nonnull(strstr(body, "\nid: 5\n"));
    ck_assert_ptr_nonnull(strstr(body, "\nid: 10\n"));
    expect(end(&run), 0);
}
END_TEST

START_TEST(clients_that_take_nothing_change_nothing)
{
    int idle[40]; /* more than the server allows */
    char host[32];
    double step = 1e-4;
    run = start_held("--watch", &step);
    (void)snprintf(host, sizeof host, "127.0.0.1:%d", run.port);
    for (size_t i = 0; i < 40; ++i) {
        idle[i] = i % 2 == 0 ? ask(run.port, "GET /frames", host)
                             : connect_to("127.0.0.1", run.port);
        ck_assert_int_ge(idle[i], 0);
    }
    go_on(&run);
    expect(end(&run), 0);
    for (size_t i = 0; i < 40; ++i) {
        (void)close(idle[i]);
    }
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT
                      "/alone --quiet --set stepper.fixed_step=%.17e && cd " OUT
                      " && cmp r/series.csv alone/series.csv && cmp r/final.csv "
                      "alone/final.csv",
                 step),
           0);
}
END_TEST

START_TEST(a_run_elsewhere_is_watched_until_it_ends)
{
    double step = 1e-4;
    const served other = start_held("", &step);
    run = start_server("view --watch " OUT "/r");
    const int client = ask_frames("/frames", "");
    go_on(&other);
    ck_assert_int_eq(answer(client), 200);
    ck_assert_ptr_nonnull(strstr(body, "\nid: 10\n"));
    ck_assert_ptr_nonnull(strstr(body, "\"result\":\"status: done"));
    expect(end(&run), 0);
    expect(end(&other), 0);
    expect(shell("test ! -e " OUT "/r/run.html"), 0);
    expect(shell(WEFT " view --watch " OUT "/r 2>&1"), 2);
    says("no run is under way there");
}
END_TEST

/* Reloads the page until the server is gone; how often it came. */
static int reload(void)
{
    const struct timespec pause = { .tv_nsec = 100000000 };
    char request[128];
    int pages = 0;
    const int length = snprintf(request, sizeof request,
                                "GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n"
                                "Connection: close\r\n\r\n",
                                run.port);
    for (int client; (client = connect_to("127.0.0.1", run.port)) >= 0;) {
        (void)send(client, request, (size_t)length, MSG_NOSIGNAL);
        pages += answer(client) == 200;
        (void)nanosleep(&pause, NULL);
    }
    return pages;
}

/* Without an end to its patience the server would answer for ever. */
START_TEST(a_client_that_reloads_does_not_keep_the_server_alive)
{
    double step = 1e-4;
    const served other = start_held("", &step);
    run = start_server("view --watch " OUT "/r");
    ck_assert_int_eq(get("/"), 200);
    go_on(&other);
    expect(end(&other), 0);
    (void)reload();
    expect(end(&run), 0);
}
END_TEST

/* One round of the network may be under way. */
START_TEST(a_client_that_reloads_does_not_hold_a_signal_up)
{
    double step = 1e-4;
    const served other = start_held("", &step);
    run = start_server("view --watch " OUT "/r");
    ck_assert_int_eq(get("/"), 200);
    ck_assert_int_eq(kill(run.pid, SIGINT), 0);
    ck_assert_int_lt(reload(), 5);
    expect(end(&run), 130);
    (void)kill(other.pid, SIGKILL);
    expect(end(&other), 128 + SIGKILL);
}
END_TEST

START_TEST(a_signal_ends_the_server_and_not_the_run)
{
    const served other = start("run " OUT "/s.yaml --out " OUT "/r --quiet " SLOW);
    wait_for("test -e " OUT "/r/run.vtkhdf");
    run = start_server("view --watch " OUT "/r");
    expect(stop(&run, SIGTERM), 143);
    ck_assert_int_lt(connect_to("127.0.0.1", run.port), 0);
    run = start_server("view --watch " OUT "/r"); /* it is still under way */
    expect(stop(&other, SIGKILL), 128 + SIGKILL);
    expect(end(&run), 0); /* there is no result.yaml, but nobody has the lock */
}
END_TEST

START_TEST(the_server_ends_with_a_run_that_is_killed)
{
    start_run(SLOW);
    expect(stop(&run, SIGKILL), 128 + SIGKILL);
    /* end() has read to the end of its output, which the server had too */
    ck_assert_int_lt(connect_to("127.0.0.1", run.port), 0);
}
END_TEST

START_TEST(a_port_that_is_taken_is_reported_and_the_run_goes_on)
{
    start_run(SLOW);
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT
                      "/b --quiet --watch --port %d 2>&1",
                 run.port),
           0);
    says("weft: error: no server on 127.0.0.1:");
    says("Address already in use");
    says("/b/run.html\n");
    expect(shell(WEFT " view --watch " OUT "/r --port %d 2>&1", run.port), 4);
    expect(stop(&run, SIGTERM), 143);
}
END_TEST

START_TEST(wrong_command_lines_are_refused)
{
    static const char *const lines[][2] = {
        { "run " OUT "/s.yaml --port 8000", "--port needs --watch" },
        { "run " OUT "/s.yaml --watch --port 80", "not a number from 1024 to 65535" },
        { "run " OUT "/s.yaml --watch --port 8o", "not a number from 1024 to 65535" },
        { "view a b --watch", "--watch shows one run" },
        { "view a --watch --out x", "--watch shows one run" },
        { "view a --port 8000", "--port needs --watch" },
        { "view " OUT "/nowhere --watch", "no run is under way there" },
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        expect(shell(WEFT " %s 2>&1", lines[i][0]), 2);
        says(lines[i][1]);
    }
    expect(shell("test ! -e s.run"), 0);
}
END_TEST

START_TEST(a_run_that_fails_is_shown_up_to_its_end)
{
    double step = 2e-6;
    run = start_held("--watch --set run.duration=2 --set "
                     "cloth.springs.stretch.stiffness=1e9 --set stepper.method=euler",
                     &step);
    const int client = ask_frames("/frames", "");
    go_on(&run);
    ck_assert_int_eq(answer(client), 200);
    expect(end(&run), 1);
    ck_assert_msg(strstr(body, "\"result\":\"status: failed") != NULL, "%s", body);
}
END_TEST

START_TEST(the_url_is_a_document_where_progress_is_yaml)
{
    expect(shell(WEFT " run " OUT "/s.yaml --out " OUT "/r --watch --progress yaml"),
           0);
    says("--- {event: watch, url: \"http://127.0.0.1:");
    says("--- {event: page, url: \"file:///");
}
END_TEST

TEST_SUITE(watch)
{
    Suite *all = suite_create("watch");
    TCase *server = tcase_create("server");
    tcase_add_checked_fixture(server, begin, NULL);
    tcase_set_timeout(server, 300);
    tcase_add_test(server,
                   the_page_comes_with_a_policy_that_lets_it_ask_its_server_alone);
    tcase_add_test(server, no_other_name_of_this_machine_is_answered);
    tcase_add_test(server, nothing_but_the_page_and_its_frames_is_there);
    tcase_add_test(server, every_frame_comes_with_its_rows_and_then_the_result);
    tcase_add_test(server, a_client_gets_what_it_lacks);
    tcase_add_test(server, clients_that_take_nothing_change_nothing);
    tcase_add_test(server, a_run_elsewhere_is_watched_until_it_ends);
    tcase_add_test(server, a_client_that_reloads_does_not_keep_the_server_alive);
    tcase_add_test(server, a_client_that_reloads_does_not_hold_a_signal_up);
    tcase_add_test(server, a_signal_ends_the_server_and_not_the_run);
    tcase_add_test(server, the_server_ends_with_a_run_that_is_killed);
    tcase_add_test(server, a_port_that_is_taken_is_reported_and_the_run_goes_on);
    tcase_add_test(server, wrong_command_lines_are_refused);
    tcase_add_test(server, a_run_that_fails_is_shown_up_to_its_end);
    tcase_add_test(server, the_url_is_a_document_where_progress_is_yaml);
    suite_add_tcase(all, server);
    return all;
}

#endif
