#include "fingertip.h"

/* --- Bytes ------------------------------------------------------------------------------------------------------- */

struct cursor {
    const uint8_t *bytes;
    size_t left;
    bool is_short; /* more was asked for than there is; then everything reads 0 */
};

static uint64_t take(struct cursor *from, size_t bytes)
{
    uint64_t number = 0;
    if (from->left < bytes) {
        from->is_short = true;
        from->left = 0;
        return 0;
    }
    for (size_t i = 0; i < bytes; i++) {
        number |= (uint64_t)from->bytes[i] << (8u * i);
    }
    from->bytes += bytes;
    from->left -= bytes;
    return number;
}

static uint8_t take_u8(struct cursor *from) { return (uint8_t)take(from, 1); }

static uint16_t take_u16(struct cursor *from) { return (uint16_t)take(from, 2); }

static uint32_t take_u32(struct cursor *from) { return (uint32_t)take(from, 4); }

static int16_t take_i16(struct cursor *from)
{
    uint16_t number = take_u16(from);
    return (int16_t)(number <= (uint16_t)INT16_MAX ? (int32_t)number : (int32_t)number - 65536);
}

static int32_t take_i32(struct cursor *from)
{
    uint32_t number = take_u32(from);
    /* Two's complement without a conversion that C leaves to the compiler. */
    return number <= (uint32_t)INT32_MAX ? (int32_t)number : -(int32_t)(UINT32_MAX - number) - 1;
}

void ft_put_u16(uint8_t out[2], uint16_t number)
{
    out[0] = (uint8_t)(number & 0xFFu);
    out[1] = (uint8_t)(number >> 8);
}

void ft_put_i32(uint8_t out[4], int32_t number)
{
    uint32_t bits = (uint32_t)number;
    for (unsigned i = 0; i < 4; i++) {
        out[i] = (uint8_t)(bits >> (8u * i) & 0xFFu);
    }
}

/* CRC-16/IBM-3740: of the digits 123456789 it is 0x29B1. */
static uint16_t crc16(const uint8_t *bytes, size_t length)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < length; i++) {
        crc = (uint16_t)(crc ^ (uint16_t)(bytes[i] << 8));
        for (int bit = 0; bit < 8; bit++) {
            crc = (uint16_t)((crc & 0x8000u) != 0 ? (uint16_t)(crc << 1) ^ 0x1021u : (uint16_t)(crc << 1));
        }
    }
    return crc;
}

/* CRC-32/ISO-HDLC: of the digits 123456789 it is 0xCBF43926. */
static uint32_t crc32(uint32_t crc, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
        }
    }
    return crc;
}

/* --- Frames ------------------------------------------------------------------------------------------------------ */

#define HEADER 14u
#define WARNINGS 0x47FFu /* bits 0 to 10 and 14 */
#define FAULTY 0x80u

static bool is_fault(uint8_t code)
{
    return (code >= 1 && code <= 11) || (code >= 16 && code <= 24);
}

/* 2^(code / 8), rounded: a standard deviation of version 3. */
static int32_t of_eighths(uint8_t code)
{
    /* 2^(j / 8) in 30 fraction bits. */
    static const uint32_t eighths[8] = {1073741824u, 1170923762u, 1276901417u, 1392470869u,
                                        1518500250u, 1655936265u, 1805811301u, 1969251188u};
    uint64_t value = (((uint64_t)eighths[code % 8u] << (code / 8u)) + (1u << 29)) >> 30;
    return value < (uint64_t)INT32_MAX && code != 255 ? (int32_t)value : INT32_MAX;
}

static enum ft_result read_reading(struct cursor *from, struct ft_frame *frame)
{
    struct ft_values *values = &frame->of.values[0];
    frame->tips = 1;
    values->warnings = take_u16(from);
    frame->fraction_bits = take_u8(from);
    values->touch = take_u8(from);
    values->rise = take_i32(from);
    values->force_un = take_i32(from);
    values->indentation_nm = take_i32(from);
    values->rise_sigma = take_i32(from);
    values->force_sigma_un = take_i32(from);
    values->indentation_sigma_nm = take_i32(from);
    values->has_feedback = from->left == 8;
    if (values->has_feedback) {
        values->feedback_un = take_i32(from);
        values->feedback_sigma_un = take_i32(from);
    }
    bool allowed = values->feedback_un >= 0 && values->feedback_sigma_un >= 0 && (values->warnings & ~WARNINGS) == 0 && frame->fraction_bits <= 31 && values->touch <= FT_TOUCHED
        && values->rise_sigma >= 0 && values->force_sigma_un >= 0 && values->indentation_sigma_nm >= 0;
    return allowed ? FT_WHOLE : FT_VALUE;
}

static enum ft_result read_tip_values(struct cursor *from, uint8_t tip, struct ft_values *values)
{
    uint8_t first = take_u8(from);
    uint16_t word = take_u16(from);
    int32_t rise = take_i32(from);
    int32_t force = take_i32(from);
    int32_t indentation = take_i32(from);
    uint8_t sigmas[3];
    for (int i = 0; i < 3; i++) {
        sigmas[i] = take_u8(from);
    }
    if ((first & 0x0Fu) != tip || (first & 0x40u) != 0) {
        return FT_VALUE;
    }
    if ((first & FAULTY) != 0) {
        bool blank = (first & 0x30u) == 0 && (word >> 8) == 0 && rise == 0 && force == 0 && indentation == 0
            && sigmas[0] == 0 && sigmas[1] == 0 && sigmas[2] == 0;
        values->fault = (uint8_t)(word & 0xFFu);
        return blank && is_fault(values->fault) ? FT_WHOLE : FT_VALUE;
    }
    values->touch = (uint8_t)(first >> 4 & 3u);
    values->warnings = word;
    values->rise = rise;
    values->force_un = force;
    values->indentation_nm = indentation;
    values->rise_sigma = of_eighths(sigmas[0]);
    values->force_sigma_un = of_eighths(sigmas[1]);
    values->indentation_sigma_nm = of_eighths(sigmas[2]);
    return values->touch <= FT_TOUCHED && (word & ~WARNINGS) == 0 ? FT_WHOLE : FT_VALUE;
}

static enum ft_result read_readings(struct cursor *from, struct ft_frame *frame)
{
    frame->tips = take_u8(from);
    frame->fraction_bits = take_u8(from);
    if (frame->tips < 1 || frame->tips > FT_MAX_TIPS || frame->fraction_bits > 31) {
        return FT_VALUE;
    }
    if (from->left != 18u * frame->tips) {
        return FT_LENGTH;
    }
    for (uint8_t tip = 0; tip < frame->tips; tip++) {
        enum ft_result result = read_tip_values(from, tip, &frame->of.values[tip]);
        if (result != FT_WHOLE) {
            return result;
        }
    }
    return FT_WHOLE;
}

static enum ft_result read_hello(struct cursor *from, struct ft_frame *frame)
{
    struct ft_hello *hello = &frame->of.hello;
    for (int i = 0; i < 3; i++) {
        hello->firmware[i] = take_u8(from);
    }
    hello->reset_cause = take_u8(from);
    hello->design_hash = take(from, 8);
    hello->table_version = take_u32(from);
    hello->report_period_us = take_u32(from);
    hello->stored = take_u8(from);
    hello->last_fault = take_u8(from);
    hello->resets_in_a_row = take_u8(from);
    hello->last_fault_detail = take_u32(from);
    hello->stored_number = take_u32(from);
    hello->samples_lost = take_u32(from);
    hello->samples_rejected = take_u32(from);
    hello->frames_dropped = take_u32(from);
    hello->commands_refused = take_u32(from);
    if (frame->version == 3) {
        hello->tips = take_u8(from);
        if (hello->tips < 1 || hello->tips > FT_MAX_TIPS) {
            return FT_VALUE;
        }
    }
    return hello->reset_cause <= 6 && hello->stored <= 4 && hello->last_fault <= 6 ? FT_WHOLE : FT_VALUE;
}

static bool is_outcome(uint8_t code, bool load)
{
    return load ? code == 0 || code == 3 || code == 5 || code == 6 || code == 8 || (code >= 10 && code <= 13) || code == 15
                : code <= 9 || code == 14 || code == 16;
}

static enum ft_result read_answer(struct cursor *from, struct ft_frame *frame)
{
    struct ft_answer *answer = &frame->of.answer;
    if (frame->version == 3) {
        answer->tip = take_u8(from);
    }
    answer->command = take_u8(from);
    answer->command_sequence = take_u16(from);
    answer->outcome = take_u8(from);
    answer->findings = take_u16(from);
    answer->has_known = answer->command == FT_INDENTATION && from->left == 16;
    if (answer->has_known) {
        answer->force_un = take_i32(from);
        answer->force_sigma_un = take_i32(from);
        answer->curvature_per_km = take_i32(from);
        answer->curvature_sigma_per_km = take_i32(from);
    }
    bool load = answer->command >= FT_ARM && answer->command <= FT_READ_BACK;
    bool known = load || (answer->command >= FT_TARE && answer->command <= FT_AIR);
    return known && is_outcome(answer->outcome, load) && answer->tip < FT_MAX_TIPS ? FT_WHOLE : FT_VALUE;
}

/* Whether the bytes are UTF-8 (RFC 3629): no overlong forms, no surrogates, nothing beyond 0x10FFFF. */
static bool is_utf8(const char *text, size_t length)
{
    for (size_t at = 0; at < length;) {
        uint8_t first = (uint8_t)text[at++];
        size_t more = first < 0x80 ? 0 : first < 0xE0 ? 1 : first < 0xF0 ? 2 : 3;
        bool leads = first < 0x80 || (first >= 0xC2 && first < 0xF5);
        if (!leads || more > length - at) {
            return false;
        }
        for (size_t i = 0; i < more; i++) {
            uint8_t next = (uint8_t)text[at++];
            uint8_t least = i > 0 ? 0x80 : first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
            uint8_t most = i > 0 ? 0xBF : first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
            if (next < least || next > most) {
                return false;
            }
        }
    }
    return true;
}

static enum ft_result read_tip_hello(struct cursor *from, struct ft_frame *frame)
{
    struct ft_tip_hello *hello = &frame->of.tip_hello;
    hello->tip = take_u8(from);
    hello->design_hash = take(from, 8);
    hello->table_version = take_u32(from);
    hello->report_period_us = take_u32(from);
    hello->stored = take_u8(from);
    hello->stored_number = take_u32(from);
    hello->samples_rejected = take_u32(from);
    uint8_t length = take_u8(from);
    if (length > sizeof hello->name - 1 || hello->stored > 4 || hello->tip >= FT_MAX_TIPS) {
        return FT_VALUE;
    }
    for (uint8_t i = 0; i < length; i++) {
        hello->name[i] = (char)take_u8(from);
    }
    return is_utf8(hello->name, length) ? FT_WHOLE : FT_VALUE;
}

static enum ft_result read_tip_data(struct cursor *from, struct ft_frame *frame)
{
    struct ft_tip_data *data = &frame->of.tip_data;
    if (frame->version == 3) {
        data->tip = take_u8(from);
    }
    data->command_sequence = take_u16(from);
    data->offset = take_u32(from);
    if (from->left < 1 || from->left > FT_MAX_DATA) {
        return FT_LENGTH;
    }
    data->length = (uint8_t)from->left;
    for (uint8_t i = 0; i < data->length; i++) {
        data->bytes[i] = take_u8(from);
    }
    return data->tip < FT_MAX_TIPS ? FT_WHOLE : FT_VALUE;
}

static enum ft_result read_band(struct cursor *from, struct ft_frame *frame)
{
    struct ft_band *band = &frame->of.band;
    if (frame->version == 3) {
        band->tip = take_u8(from);
    }
    frame->fraction_bits = take_u8(from);
    band->count = take_u8(from);
    band->from = take_i32(from);
    if (frame->fraction_bits > 31 || band->count < 1 || band->count > FT_MAX_BAND || band->from < 0 || band->tip >= FT_MAX_TIPS) {
        return FT_VALUE;
    }
    int32_t last = band->from;
    for (uint8_t i = 0; i < band->count; i++) {
        struct ft_band_row *row = &band->rows[i];
        row->to = take_i32(from);
        for (int end = 0; end < 2; end++) {
            row->force[end] = take_i16(from);
        }
        for (int end = 0; end < 2; end++) {
            row->indentation[end] = take_i16(from);
        }
        if (row->to <= last || row->force[0] > row->force[1] || row->indentation[0] > row->indentation[1]) {
            return FT_VALUE;
        }
        last = row->to;
    }
    return FT_WHOLE;
}

static enum ft_result read_body(struct cursor from, struct ft_frame *frame)
{
    *frame = (struct ft_frame){0};
    if (from.left < HEADER) {
        return FT_SHORT;
    }
    frame->version = take_u8(&from);
    frame->kind = take_u8(&from);
    frame->sequence = take_u16(&from);
    frame->time_us = take(&from, 8);
    frame->dropped = take_u16(&from);
    if (frame->version != 2 && frame->version != 3) {
        return FT_VERSION;
    }
    bool hand = frame->version == 3;
    enum ft_result result = FT_UNKNOWN;
    if (frame->kind == FT_HELLO) {
        result = read_hello(&from, frame);
    } else if (frame->kind == FT_ANSWER) {
        result = read_answer(&from, frame);
    } else if (hand && frame->kind == FT_READINGS) {
        result = read_readings(&from, frame);
    } else if (hand && frame->kind == FT_TIP_HELLO) {
        result = read_tip_hello(&from, frame);
    } else if (!hand && frame->kind == FT_READING) {
        result = read_reading(&from, frame);
    } else if (!hand && frame->kind == FT_FAULT) {
        frame->tips = 1;
        frame->of.values[0].fault = take_u8(&from);
        result = is_fault(frame->of.values[0].fault) ? FT_WHOLE : FT_VALUE;
    } else if (frame->kind == FT_TIP_DATA) {
        result = read_tip_data(&from, frame);
    } else if (frame->kind == FT_BAND) {
        result = read_band(&from, frame);
    }
    if (from.is_short) {
        return FT_LENGTH;
    }
    return result == FT_WHOLE && from.left != 0 ? FT_LENGTH : result;
}

/* Takes the stuffing out where it is; the bytes that are left, or 0. */
static size_t unstuff(uint8_t *bytes, size_t length)
{
    size_t from = 0;
    size_t to = 0;
    while (from < length) {
        size_t distance = bytes[from++];
        if (distance == 0 || from + distance - 1 > length) {
            return 0;
        }
        for (size_t i = 1; i < distance; i++) {
            bytes[to++] = bytes[from++];
        }
        if (distance < 255 && from < length) {
            bytes[to++] = 0;
        }
    }
    return to;
}

enum ft_result ft_push(struct ft_reader *reader, uint8_t byte, struct ft_frame *frame)
{
    if (byte != 0) {
        if (reader->length < FT_MAX_FRAME) {
            reader->bytes[reader->length++] = byte;
        } else {
            reader->overflowed = true;
        }
        return FT_NONE;
    }
    size_t length = reader->length;
    bool overflowed = reader->overflowed;
    reader->length = 0;
    reader->overflowed = false;
    if (overflowed) {
        return FT_STUFFING;
    }
    if (length == 0) {
        return FT_NONE;
    }
    length = unstuff(reader->bytes, length);
    if (length == 0 || length > FT_MAX_BODY + 2) {
        return FT_STUFFING;
    }
    if (length < 2) {
        return FT_SHORT;
    }
    length -= 2;
    uint16_t check = (uint16_t)(reader->bytes[length] | reader->bytes[length + 1] << 8);
    if (crc16(reader->bytes, length) != check) {
        return FT_CRC;
    }
    return read_body((struct cursor){reader->bytes, length, false}, frame);
}

double ft_pascals(int32_t counts, uint8_t fraction_bits)
{
    return (double)counts / (double)((uint32_t)1 << (fraction_bits & 31u));
}

const struct ft_band_row *ft_band_at(const struct ft_band *band, uint8_t band_bits, int32_t rise, uint8_t rise_bits)
{
    double pascals = ft_pascals(rise, rise_bits);
    if (pascals < ft_pascals(band->from, band_bits)) {
        return NULL;
    }
    for (uint8_t i = 0; i < band->count && i < FT_MAX_BAND; i++) {
        if (pascals <= ft_pascals(band->rows[i].to, band_bits)) {
            return &band->rows[i];
        }
    }
    return NULL;
}

double ft_band_end(int32_t read, int16_t tenths)
{
    return (double)read * (1.0 + (double)tenths / 1000.0);
}

/* --- Commands ---------------------------------------------------------------------------------------------------- */

#define MAX_PAYLOAD 68u

/* The frame of a body of less than 254 bytes, which lies in `out` from 1 on. */
static size_t finish(uint8_t *out, size_t length)
{
    ft_put_u16(out + 1 + length, crc16(out + 1, length));
    size_t code = 0;
    for (size_t at = 1; at < length + 3; at++) {
        if (out[at] == 0) {
            out[code] = (uint8_t)(at - code);
            code = at;
        }
    }
    out[code] = (uint8_t)(length + 3 - code);
    out[length + 3] = 0;
    return length + 4;
}

static size_t command(uint8_t *out, const uint8_t *head, size_t head_length, const uint8_t *payload, size_t length)
{
    if (length > MAX_PAYLOAD) {
        return 0;
    }
    for (size_t i = 0; i < head_length; i++) {
        out[1 + i] = head[i];
    }
    for (size_t i = 0; i < length; i++) {
        out[1 + head_length + i] = payload[i];
    }
    return finish(out, head_length + length);
}

size_t ft_command(uint8_t out[FT_MAX_FRAME], uint8_t kind, uint16_t sequence, const uint8_t *payload, size_t length)
{
    uint8_t head[4] = {2, kind, 0, 0};
    ft_put_u16(head + 2, sequence);
    return command(out, head, sizeof head, payload, length);
}

size_t ft_hand_command(uint8_t out[FT_MAX_FRAME], uint8_t tip, uint8_t kind, uint16_t sequence, const uint8_t *payload,
                       size_t length)
{
    uint8_t head[5] = {3, kind, 0, 0, tip};
    ft_put_u16(head + 2, sequence);
    return command(out, head, sizeof head, payload, length);
}

/* --- Tip files --------------------------------------------------------------------------------------------------- */

#define HEAD 40u
#define ENTRY 12u
#define KINDS 8u

enum section { CONSTANTS = 1, TABLES = 2, CALIBRATION = 3, NAME = 4, RELAXATION = 5, OBJECT = 6, FEEDBACK = 7, ZERO = 8 };

static bool within(int32_t value, int32_t least, int32_t most) { return value >= least && value <= most; }

static enum ft_tip_result read_constants(struct ft_tip *tip, struct cursor from)
{
    tip->rest_pressure_pa = take_i32(&from);
    tip->maximum_pressure_pa = take_i32(&from);
    tip->range_pa[0] = take_i32(&from);
    tip->range_pa[1] = take_i32(&from);
    tip->resolution_mpa = take_i32(&from);
    tip->noise_mpa = take_i32(&from);
    uint32_t quantity = take_u32(&from);
    tip->transducer = take_u8(&from);
    tip->address = take_u8(&from);
    (void)take(&from, 10);
    int64_t span = (int64_t)tip->range_pa[1] - tip->range_pa[0];
    bool allowed = !from.is_short && from.left == 0 && within(tip->rest_pressure_pa, -2000000, 2000000)
        && tip->maximum_pressure_pa > tip->rest_pressure_pa && tip->maximum_pressure_pa <= 2000000 && span > 0
        && span <= 2000000 && tip->resolution_mpa > 0 && tip->noise_mpa >= 0 && quantity <= 1 && tip->transducer <= 3
        && tip->address <= 127;
    tip->absolute = quantity == 1;
    return allowed ? FT_TIP_OK : FT_TIP_FIELD;
}

static enum ft_tip_result read_tables(struct ft_tip *tip, struct cursor from)
{
    uint32_t bits = take_u32(&from);
    tip->last_rise = take_i32(&from);
    for (int i = 0; i < 8; i++) {
        (void)take_u32(&from);
    }
    bool allowed = !from.is_short && bits <= 16 && within(tip->last_rise, 1, (1 << 30) - 1) && from.left % 4 == 0;
    tip->fraction_bits = (uint8_t)bits;
    tip->table_words = (uint32_t)(from.left / 4);
    return allowed && tip->table_words > 0 ? FT_TIP_OK : FT_TIP_FIELD;
}

static enum ft_tip_result read_calibration(struct ft_tip *tip, struct cursor from)
{
    tip->has_calibration = true;
    tip->zero_mpa = take_i32(&from);
    tip->zero_temperature = take_i32(&from);
    tip->zero_mpa_per_kelvin = take_i32(&from);
    tip->gain_ppm = take_i32(&from);
    return !from.is_short && from.left == 0 ? FT_TIP_OK : FT_TIP_FIELD;
}

static enum ft_tip_result read_name(struct ft_tip *tip, struct cursor from)
{
    if (from.left < 1 || from.left > FT_MAX_NAME) {
        return FT_TIP_FIELD;
    }
    for (size_t i = 0; from.left > 0; i++) {
        uint8_t c = take_u8(&from);
        bool allowed = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        if (!allowed) {
            return FT_TIP_FIELD;
        }
        tip->name[i] = (char)c;
    }
    return FT_TIP_OK;
}

static enum ft_tip_result read_section(struct ft_tip *tip, uint16_t kind, struct cursor from)
{
    switch (kind) {
    case CONSTANTS:
        return read_constants(tip, from);
    case TABLES:
        return read_tables(tip, from);
    case CALIBRATION:
        return read_calibration(tip, from);
    case NAME:
        return read_name(tip, from);
    case RELAXATION:
        tip->has_relaxation = true;
        return from.left >= 64 && (from.left - 48) % 16 == 0 ? FT_TIP_OK : FT_TIP_FIELD;
    case OBJECT:
        tip->has_object = true;
        return from.left > 80 ? FT_TIP_OK : FT_TIP_FIELD;
    case FEEDBACK:
        tip->has_feedback = true;
        return from.left > 0 ? FT_TIP_OK : FT_TIP_FIELD;
    case ZERO:
        tip->has_zero = true;
        return from.left == 28 ? FT_TIP_OK : FT_TIP_FIELD;
    default:
        return FT_TIP_SECTION;
    }
}

enum ft_tip_result ft_tip_read(struct ft_tip *tip, const uint8_t *bytes, size_t length)
{
    static const uint8_t magic[4] = {'F', 'T', 'I', 'P'};
    *tip = (struct ft_tip){0};
    if (length < HEAD) {
        return FT_TIP_SHORT;
    }
    for (size_t i = 0; i < 4; i++) {
        if (bytes[i] != magic[i]) {
            return FT_TIP_MAGIC;
        }
    }
    struct cursor head = {bytes + 4, HEAD - 4, false};
    uint16_t layout = take_u16(&head);
    uint16_t head_length = take_u16(&head);
    tip->length = take_u32(&head);
    tip->check = take_u32(&head);
    tip->hash = take(&head, 8);
    tip->table_version = take_u32(&head);
    tip->certificate = take(&head, 8);
    uint32_t sections = take_u32(&head);
    if (layout != 1) {
        return FT_TIP_LAYOUT;
    }
    if (tip->length > length || tip->length < HEAD) {
        return FT_TIP_SHORT;
    }
    uint32_t crc = crc32(0xFFFFFFFFu, bytes, 12);
    crc = crc32(crc, bytes + 16, tip->length - 16);
    if ((crc ^ 0xFFFFFFFFu) != tip->check) {
        return FT_TIP_CHECK;
    }
    if (sections > KINDS || head_length != HEAD + ENTRY * sections || head_length > tip->length) {
        return FT_TIP_SECTION;
    }
    uint16_t last_kind = 0;
    unsigned found = 0;
    size_t end = head_length;
    for (uint32_t i = 0; i < sections; i++) {
        struct cursor entry = {bytes + HEAD + ENTRY * i, ENTRY, false};
        uint16_t kind = take_u16(&entry);
        uint16_t version = take_u16(&entry);
        uint32_t offset = take_u32(&entry);
        uint32_t size = take_u32(&entry);
        size_t begin = (end + 3) / 4 * 4;
        if (kind <= last_kind || version != 1 || offset != begin || begin > tip->length || size > tip->length - begin) {
            return FT_TIP_SECTION;
        }
        for (size_t at = end; at < begin; at++) {
            if (bytes[at] != 0) {
                return FT_TIP_SECTION;
            }
        }
        enum ft_tip_result result = read_section(tip, kind, (struct cursor){bytes + offset, size, false});
        if (result != FT_TIP_OK) {
            return result;
        }
        found |= 1u << kind;
        last_kind = kind;
        end = begin + size;
    }
    unsigned needed = 1u << CONSTANTS | 1u << TABLES | 1u << NAME;
    return (found & needed) == needed && end == tip->length ? FT_TIP_OK : FT_TIP_SECTION;
}
