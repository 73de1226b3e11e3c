/* Commands and their answers, section 4. */
#include "internal.h"

static ab_code refuse_state(const ab_board *board, const char *what, ab_text *reason)
{
    static const char *const names[] = {"IDLE", "CONFIGURED", "RUNNING"};

    ab_text_add(reason, names[board->state]);
    ab_text_add(reason, what);
    return AB_WRONG_STATE;
}

static ab_code refuse_payload(ab_text *reason)
{
    ab_text_add(reason, "malformed payload: a wrong length, or a value that cannot be");
    return AB_BAD_VALUE;
}

static ab_code configure(ab_board *board, const uint8_t *payload, size_t n, ab_text *reason)
{
    const ab_port *port = &board->config->port;
    char nearest[AB_REASON_BYTES] = "";
    ab_configuration wanted;
    ab_code code;

    if (!ab_read_configuration(payload, n, &wanted))
        return refuse_payload(reason);
    if (board->state == AB_RUNNING)
        return refuse_state(board, "; STOP first", reason);
    if (!port->rate(port->context, wanted.rate_hz_numerator, wanted.rate_hz_denominator, nearest,
                    sizeof nearest)) {
        ab_text_add(reason, nearest);
        return AB_BAD_VALUE;
    }
    code = ab_refusal(&wanted, &board->head, reason);
    if (code != AB_OK)
        return code;
    ab_forget_all_blocks(board);
    board->wanted = wanted;
    ab_capture_configure(board);
    board->state = AB_CONFIGURED;
    return AB_OK;
}

static ab_code start(ab_board *board, ab_text *reason)
{
    const ab_port *port = &board->config->port;

    if (board->state != AB_CONFIGURED)
        return refuse_state(board, "; CONFIGURED wanted", reason);
    ab_forget_all_blocks(board);
    ab_capture_start(board);
    ab_preview_start(board);
    board->overflow = 0;
    board->state = AB_RUNNING;
    port->start(port->context, board->wanted.rate_hz_numerator, board->wanted.rate_hz_denominator);
    return AB_OK;
}

static ab_code stop(ab_board *board)
{
    const ab_port *port = &board->config->port;

    if (board->state == AB_RUNNING) {
        port->stop(port->context);
        ab_capture_stop(board);
        board->preview_count = 0;
        board->preview_gathered = 0;
        board->state = AB_CONFIGURED;
    }
    return AB_OK;
}

static ab_code refuse_block(const char *before, uint32_t id, const char *after, ab_text *reason)
{
    ab_text_say(reason, before, id);
    ab_text_add(reason, after);
    return AB_UNKNOWN_BLOCK;
}

static ab_code resend(ab_board *board, const uint8_t *payload, size_t n, ab_text *reason)
{
    ab_resend range;

    if (!ab_read_resend(payload, n, &range))
        return refuse_payload(reason);
    if (ab_find_block(board, range.block_id) == NULL)
        return refuse_block("block ", range.block_id, " is not held", reason);
    if ((uint64_t)range.first + range.count > board->wanted.block_length) {
        ab_text_say(reason, "", range.count);
        ab_text_say(reason, " samples from ", range.first);
        ab_text_say(reason, " wanted of a block of ", board->wanted.block_length);
        return AB_BAD_VALUE;
    }
    if (board->n_resend == AB_RESEND_QUEUE) {
        ab_text_add(reason, "the resend queue is full; ask again later");
        return AB_WRONG_STATE;
    }
    board->resend[board->n_resend++] = range;
    return AB_OK;
}

static ab_code release(ab_board *board, const uint8_t *payload, size_t n, ab_text *reason)
{
    ab_release wanted;

    if (!ab_read_release(payload, n, &wanted))
        return refuse_payload(reason);
    if (wanted.block_id == 0 || wanted.block_id > board->last_block)
        return refuse_block("block ", wanted.block_id, " was never given out", reason);
    ab_forget_block(board, wanted.block_id);
    return AB_OK;
}

static ab_code tell_status(const ab_board *board, uint8_t *answer)
{
    ab_board_status status = {0};

    status.state = board->state;
    status.next_sequence = board->sequence + 1;
    status.next_sample = board->next_sample;
    for (uint32_t i = 0; i < board->n_slots; i++) {
        const uint32_t id = board->config->blocks[i].id;

        status.buffered_blocks += id != 0;
        if (id != 0 && (status.oldest_block == 0 || id < status.oldest_block))
            status.oldest_block = id;
    }
    status.stream_samples_dropped = board->stream_dropped;
    status.triggers_missed = board->triggers_missed;
    status.adc_overruns = board->adc_overruns;
    ab_write_board_status(answer, &status);
    return AB_OK;
}

/* A command that only the board knows, where it knows one. */
static ab_code ask_port(const ab_board *board, const ab_header *header, const uint8_t *payload,
                        size_t n, uint8_t *answer, ab_text *reason)
{
    const ab_port *port = &board->config->port;
    char words[AB_REASON_BYTES] = "";
    ab_code code = AB_UNKNOWN_COMMAND;

    if (port->command != NULL)
        code = port->command(port->context, header->type, payload, n, answer, words, sizeof words);
    if (code == AB_UNKNOWN_COMMAND && words[0] == '\0')
        ab_text_add(reason, "no command of this type");
    ab_text_add(reason, words);
    return code;
}

/* Do what a command asks; the only list of commands here, all else is in the table of messages.
   A refusal writes its reason; what answers with a record writes it at `answer`. */
static ab_code carry_out(ab_board *board, const ab_header *header, const uint8_t *payload,
                         size_t n, uint8_t *answer, ab_text *reason)
{
    if (header->session != board->session) {
        ab_text_add(reason, "board session ");
        ab_text_hex(reason, board->session);
        ab_text_add(reason, ", command ");
        ab_text_hex(reason, header->session);
        return AB_WRONG_SESSION;
    }
    if (n != 0 && ab_command_is_bare(header->type))
        return refuse_payload(reason);
    switch (header->type) {
    case AB_CONFIGURE:
        return configure(board, payload, n, reason);
    case AB_START:
        return start(board, reason);
    case AB_STOP:
        return stop(board);
    case AB_STATUS:
        return tell_status(board, answer);
    case AB_RESEND:
        return resend(board, payload, n, reason);
    case AB_RELEASE:
        return release(board, payload, n, reason);
    default:
        return ask_port(board, header, payload, n, answer, reason);
    }
}

static void answer_command(ab_board *board)
{
    uint8_t reply[2 + AB_REASON_BYTES];
    uint8_t answer[2 + AB_ANSWER_BYTES] = {AB_OK, 0}; /* no reason */
    ab_text reason = ab_text_begin((char *)reply + 2, AB_REASON_BYTES);
    ab_header header;
    const uint8_t *payload;
    size_t n;
    const ab_frame_result found =
        ab_receiver_decode(&board->receiver, board->command, &header, &payload, &n);
    ab_code code;

    board->command = 0;
    if (found != AB_FRAME_OK && found != AB_FRAME_TYPE && found != AB_FRAME_VERSION)
        return;
    if (header.type == AB_HELLO) { /* of any version: the host then sees which versions meet */
        board->greeting = true;
        board->greeting_tag = header.tag;
        board->greeting_at = 0;
        return;
    }
    if (found == AB_FRAME_VERSION || header.type >= AB_REPLY)
        return;
    code = carry_out(board, &header, payload, n, answer + 2, &reason);
    if (code == AB_OK) {
        ab_compose_now(board, header.type | AB_REPLY, header.tag, answer,
                       2u + ab_answer_bytes(header.type));
        return;
    }
    reply[0] = (uint8_t)code;
    reply[1] = (uint8_t)(reason.at - (char *)reply - 2);
    ab_compose_now(board, header.type | AB_REPLY, header.tag, reply, 2u + reply[1]);
}

/* The next fragment of the dictionary. */
static void greet(ab_board *board)
{
    const unsigned at = board->greeting_at;
    const unsigned left = board->dictionary_size - at;
    const unsigned n = left < AB_PIECE_BYTES ? left : AB_PIECE_BYTES;
    const ab_port *port = &board->config->port;
    uint8_t prefix[AB_FRAGMENT_HEAD_BYTES];
    const ab_fragment_head head = {board->dictionary_size, board->greeting_at};
    const ab_piece pieces[2] = {{prefix, sizeof prefix}, {board->dictionary + at, n}};
    ab_header header = {0};

    ab_write_fragment_head(prefix, &head);
    header.type = AB_HELLO | AB_REPLY;
    header.tag = board->greeting_tag;
    header.ticks = port->ticks(port->context);
    ab_compose(board, &header, pieces, 2);
    board->greeting_at = (uint16_t)(at + n);
    board->greeting = left > n;
}

bool ab_answer(ab_board *board)
{
    if (board->greeting)
        greet(board);
    else if (board->command != 0)
        answer_command(board);
    else
        return false;
    return true;
}
