/* SPDX-License-Identifier: BSD-3-Clause */
/* watch_server.c -- the page of a run and its growing frames by HTTP, to browsers of
 * this machine. One thread; it reads the run's files anew when they change. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/record/page.h"
#include "program/run/interrupt.h"
#include "program/watch/watch.h"

#define LOOK     0.1  /* [s] between two looks at the files */
#define FAREWELL 3.0  /* [s] after the run: for new requests, and idle browsers */
#define SLOWEST  30.0 /* [s] after the run, for those that take something */
#define LAST     0.5  /* [s] after a signal */
enum {
    WAIT = 50,       /* [ms] for the network */
    CLIENTS = 32,    /* connections */
    IDLE = 30,       /* [s] until a connection that takes nothing is closed */
    BLOCK = 1 << 16, /* [B] */
    LAG = 60         /* frames: a browser farther behind leaves out some */
};

typedef struct watch_server watch_server;

/* The frames on their way to a browser. */
typedef struct feed {
    watch_server *server; /* NULL: there is none */
    struct MHD_Connection *connection;
    size_t next;           /* frame of run.vtkhdf */
    long rows;             /* [B] of series.csv that it has */
    char *text;            /* the message under way */
    size_t size, sent;     /* of it */
    bool suspended, ended; /* ended: the message is the last */
} feed;

struct watch_server {
    const watch_def *def;
    struct MHD_Daemon *daemon;
    char hosts[2][32]; /* what a browser may call this server */
    player_page page;
    bool frames, open;     /* there is a run.vtkhdf; page has it open */
    struct timespec state; /* of run.vtkhdf when page was opened */
    bool over;
    double looked, served; /* [s]; served: a page that has not asked for frames */
    double moved;          /* [s] when the run ended or a browser took something */
    double ended;          /* [s] when the run was found to be over */
    feed feeds[CLIENTS];
    size_t fed; /* of them */
};

/* ---- the run ---------------------------------------------------------------- */

/* Reads all frames that there are. Closed first: libhdf5 shares what it knows of a file
 * among those who have it open. */
static void reopen(watch_server *self)
{
    const bool first = self->page.stride == 0;
    player_page_close(&self->page);
    self->page = (player_page){ .budget = PLAYER_BUDGET, .live = true };
    self->open
        = player_page_open(&self->page, &self->def->directory, 1, NULL) == WEFT_OK;
    if (self->open && first && self->def->writes) {
        char path[RECORD_PATH];
        (void)record_path(self->def->directory, "run.html", path, NULL);
        (void)record_player(&self->def->directory, 1, path, NULL);
    }
}

/* A file that is not readable while it changes is tried again. */
static void look(watch_server *self)
{
    const watch_def *def = self->def;
    char path[RECORD_PATH];
    struct stat file;
    const double now = weft__wall_clock();
    if (now < self->looked + LOOK || (self->over && self->open)) {
        return;
    }
    self->looked = now;
    if (!self->over) {
        self->over = interrupt_signal() != 0
                     || record_exists(def->directory, "result.yaml")
                     || (def->parent != 0 ? getppid() != def->parent
                                          : !record_outdir_locked(def->directory));
        self->moved = self->ended = now;
    }
    self->frames = record_path(def->directory, "run.vtkhdf", path, NULL) == WEFT_OK
                   && stat(path, &file) == 0;
    if (self->frames
        && (self->over || !self->open || file.st_mtim.tv_sec != self->state.tv_sec
            || file.st_mtim.tv_nsec != self->state.tv_nsec)) {
        self->state = file.st_mtim;
        reopen(self);
    }
}

/* ---- messages --------------------------------------------------------------- */

/* The complete rows of series.csv that the browser does not have. */
static void put_rows(feed *self, FILE *out)
{
    char path[RECORD_PATH], line[4096];
    FILE *series = record_open(self->server->def->directory, "series.csv", path, NULL);
    fputs("\"series\":\"", out);
    if (series != NULL && fseek(series, self->rows, SEEK_SET) == 0) {
        while (fgets(line, sizeof line, series) != NULL && strchr(line, '\n') != NULL) {
            page_characters(out, line);
            self->rows += (long)strlen(line);
        }
    }
    putc('"', out);
    if (series != NULL) {
        (void)fclose(series);
    }
}

/* Writes the next message; false: there is none now. */
static bool write_message(feed *self)
{
    watch_server *server = self->server;
    const size_t count = server->open ? server->page.runs[0].frames->count : 0;
    const size_t step = server->open ? server->page.step : 1;
    const size_t behind = count > self->next ? count - self->next : 0;
    const size_t next = (self->next + behind / LAG + step - 1) / step * step;
    const size_t i = next >= count && behind > 0 && server->over ? count - 1 : next;
    const bool frame
        = i < count && player_page_encode(&server->page, 0, i, NULL) == WEFT_OK;
    const bool more = i < count || !server->over
                      || (server->frames && !server->open
                          && weft__wall_clock() < server->moved + FAREWELL / 2);
    if (self->ended || (!frame && more)) {
        self->next = i < count ? i + 1 : self->next; /* a damaged one is left out */
        return false;
    }
    free(self->text);
    self->text = NULL;
    self->size = self->sent = 0;
    FILE *out = open_memstream(&self->text, &self->size);
    if (out == NULL) {
        return false;
    }
    if (frame) {
        const player_page *page = &server->page;
        const record_frames *frames = page->runs[0].frames;
        fprintf(out, "id: %zu\ndata: {\"index\":%zu,\"number\":%.0f,\"time\":%.17g,", i,
                i, frames->numbers[i], frames->times[i]);
        put_rows(self, out);
        fputs(",\"block\":\"", out);
        page_base64(out, page->block, page_block_size(page->planes, page->count));
        fputs("\"}\n\n", out);
        self->next = i + 1;
    } else {
        fputs("event: end\ndata: {", out);
        put_rows(self, out);
        fputs(",\"result\":", out);
        page_file(out, server->def->directory, "result.yaml");
        fputs("}\n\n", out);
        self->ended = true;
    }
    return fclose(out) == 0 && self->size > 0;
}

static ssize_t read_feed(void *cls, uint64_t position, char *buffer, size_t most)
{
    feed *self = cls;
    (void)position;
    if (self->sent == self->size && !write_message(self)) {
        if (self->ended) {
            return MHD_CONTENT_READER_END_OF_STREAM;
        }
        self->suspended = true;
        MHD_suspend_connection(self->connection);
        return 0;
    }
    const size_t left = self->size - self->sent;
    const size_t count = left < most ? left : most;
    memcpy(buffer, self->text + self->sent, count);
    self->sent += count;
    self->server->moved = weft__wall_clock();
    return (ssize_t)count;
}

static void free_feed(void *cls)
{
    feed *self = cls;
    --self->server->fed;
    free(self->text);
    *self = (feed){ .server = NULL };
}

static void wake_all(watch_server *self)
{
    for (feed *one = self->feeds; one < self->feeds + CLIENTS; ++one) {
        if (one->suspended) {
            one->suspended = false;
            MHD_resume_connection(one->connection);
        }
    }
}

/* ---- requests --------------------------------------------------------------- */

static enum MHD_Result send_response(struct MHD_Connection *connection, unsigned code,
                                     const char *type, struct MHD_Response *response)
{
    static const char *const headers[][2] = {
        { "Cache-Control", "no-store" },
        { "X-Content-Type-Options", "nosniff" },
        { "Cross-Origin-Resource-Policy", "same-origin" },
        { "X-Frame-Options", "DENY" },
    };
    if (response == NULL) {
        return MHD_NO;
    }
    (void)MHD_add_response_header(response, "Content-Type", type);
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; ++i) {
        (void)MHD_add_response_header(response, headers[i][0], headers[i][1]);
    }
    if (code == MHD_HTTP_SERVICE_UNAVAILABLE) {
        (void)MHD_add_response_header(response, "Refresh", "1");
    }
    const enum MHD_Result result = MHD_queue_response(connection, code, response);
    MHD_destroy_response(response);
    return result;
}

static enum MHD_Result refuse(struct MHD_Connection *connection, unsigned code,
                              const char *why)
{
    return send_response(connection, code, "text/plain; charset=utf-8",
                         MHD_create_response_from_buffer(strlen(why), (void *)why,
                                                         MHD_RESPMEM_MUST_COPY));
}

static enum MHD_Result send_page(watch_server *self, struct MHD_Connection *connection)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = NULL;
    reopen(self);
    if (!self->open || (stream = open_memstream(&text, &size)) == NULL) {
        return refuse(connection, MHD_HTTP_SERVICE_UNAVAILABLE, "no frame yet\n");
    }
    self->page.stream = stream;
    page_begin(stream, weft__player_page, true);
    const weft_status status = player_page_write(&self->page, NULL);
    page_end(stream, weft__player_page);
    if (fclose(stream) != 0 || status != WEFT_OK) {
        free(text);
        return refuse(connection, MHD_HTTP_SERVICE_UNAVAILABLE, "not readable now\n");
    }
    if (!self->over) { /* who comes later has what is left of these seconds */
        self->served = self->moved = weft__wall_clock();
    }
    return send_response(
        connection, MHD_HTTP_OK, "text/html; charset=utf-8",
        MHD_create_response_from_buffer(size, text, MHD_RESPMEM_MUST_FREE));
}

static size_t request_number(struct MHD_Connection *connection, enum MHD_ValueKind kind,
                             const char *name)
{
    size_t number;
    const char *text = MHD_lookup_connection_value(connection, kind, name);
    return text != NULL && option_count(text, '\0', &number) && number < INT32_MAX
               ? number
               : 0;
}

static enum MHD_Result send_frames(watch_server *self,
                                   struct MHD_Connection *connection)
{
    feed *made = self->feeds, *const end = self->feeds + CLIENTS;
    while (made < end && made->server != NULL) {
        ++made;
    }
    if (made == end) { /* there are no more connections than feeds */
        return MHD_NO;
    }
    const size_t from = request_number(connection, MHD_GET_ARGUMENT_KIND, "frame");
    const size_t last = request_number(connection, MHD_HEADER_KIND, "Last-Event-ID");
    *made = (feed){
        .server = self,
        .connection = connection,
        .next = last >= from && last > 0 ? last + 1 : from,
        .rows = (long)request_number(connection, MHD_GET_ARGUMENT_KIND, "series"),
    };
    struct MHD_Response *response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, BLOCK, read_feed, made, free_feed);
    if (response == NULL) {
        made->server = NULL;
        return MHD_NO;
    }
    ++self->fed;
    self->served = 0.0;
    return send_response(connection, MHD_HTTP_OK, "text/event-stream", response);
}

static enum MHD_Result answer(void *cls, struct MHD_Connection *connection,
                              const char *url, const char *method, const char *version,
                              const char *upload, size_t *upload_size, void **context)
{
    watch_server *self = cls;
    (void)version;
    (void)upload;
    /* another name for this machine would let any web site read the answers */
    const char *host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Host");
    if (host == NULL
        || (strcmp(host, self->hosts[0]) != 0 && strcmp(host, self->hosts[1]) != 0)) {
        return refuse(connection, MHD_HTTP_FORBIDDEN, "no such host\n");
    }
    if (strcmp(method, "GET") != 0 || *upload_size > 0) {
        return refuse(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "only GET\n");
    }
    if (self->over && weft__wall_clock() > self->ended + FAREWELL) {
        return refuse(connection, MHD_HTTP_SERVICE_UNAVAILABLE, "the run is over\n");
    }
    if (*context == NULL) { /* the rest of the request comes first */
        *context = self;
        return MHD_YES;
    }
    return strcmp(url, "/") == 0 ? send_page(self, connection)
           : strcmp(url, "/frames") == 0
               ? send_frames(self, connection)
               : refuse(connection, MHD_HTTP_NOT_FOUND, "no such page\n");
}

/* ---- the server ------------------------------------------------------------- */

/* A socket of 127.0.0.1 alone; -1: there is none (errno). */
static int listen_on(watch_server *self)
{
    struct sockaddr_in address = { .sin_family = AF_INET,
                                   .sin_port = htons(self->def->port),
                                   .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    socklen_t size = sizeof address;
    const int on = 1, made = socket(AF_INET, SOCK_STREAM, 0);
    if (made >= 0
        && (fcntl(made, F_SETFD, FD_CLOEXEC) != 0
            || setsockopt(made, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0
            || bind(made, (struct sockaddr *)&address, size) != 0
            || listen(made, CLIENTS) != 0
            || getsockname(made, (struct sockaddr *)&address, &size) != 0)) {
        (void)close(made);
        return -1;
    }
    static const char *const names[] = { "127.0.0.1", "localhost" };
    for (size_t i = 0; i < 2; ++i) {
        (void)snprintf(self->hosts[i], sizeof self->hosts[i], "%s:%d", names[i],
                       (int)ntohs(address.sin_port));
    }
    return made;
}

static weft_status start(watch_server *self, weft_error *err)
{
    const int port = listen_on(self);
    if (port < 0) {
        return weft_error_set(err, WEFT_IO, "no server on 127.0.0.1:%d: %s",
                              (int)self->def->port, strerror(errno));
    }
    self->daemon = MHD_start_daemon(
        MHD_ALLOW_SUSPEND_RESUME, 0, NULL, NULL, answer, self, MHD_OPTION_LISTEN_SOCKET,
        port, MHD_OPTION_CONNECTION_LIMIT, (unsigned)CLIENTS,
        MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE, MHD_OPTION_END);
    if (self->daemon == NULL) {
        (void)close(port);
        return weft_error_set(err, WEFT_IO, "libmicrohttpd does not start");
    }
    printf(self->def->yaml ? "--- {event: watch, url: \"http://%s/\"}\n"
                           : "http://%s/\n",
           self->hosts[0]);
    (void)fflush(stdout);
    if (self->def->ready >= 0) {
        (void)close(self->def->ready);
    }
    return WEFT_OK;
}

weft_status watch_serve(const watch_def *def, weft_error *err)
{
    watch_server self = { .def = def };
    bool finished = false;
    TRY(start(&self, err));
    while (!finished) {
        look(&self);
        wake_all(&self);
        const double began = weft__wall_clock();
        (void)MHD_run_wait(self.daemon, WAIT);
        /* What moved in this round is later than it began, even if this process had to
         * wait for a processor. Who sends a signal waits for nothing but the last
         * message to browsers that take it. */
        const bool told = interrupt_signal() != 0;
        finished = self.over
                   && ((self.fed == 0 && (told || began > self.served + FAREWELL))
                       || began > self.moved + FAREWELL
                       || began > self.ended + (told ? LAST : SLOWEST));
    }
    wake_all(&self);
    MHD_stop_daemon(self.daemon);
    player_page_close(&self.page);
    return WEFT_OK;
}
