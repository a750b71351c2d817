/* What fingertip.h reads, as text: an example of its use, and what its tests run.
 *
 *   cc -std=c99 -o read_frames host-tests/c/read_frames.c host-tests/c/fingertip.c
 *   ./read_frames < /dev/ttyACM0          one line a frame
 *   ./read_frames tip < tip.bin           what a tip file holds
 *   ./read_frames encode TIP KIND SEQUENCE [PAYLOAD]   the bytes of a command; TIP "-": of a board of one fingertip
 */
#include "fingertip.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const RESULTS[] = {"none", "whole", "stuffing", "short", "crc", "version", "kind", "length", "value"};

static void print_values(uint8_t tip, const struct ft_values *values, uint8_t bits)
{
    printf(" | tip %u ", tip);
    if (values->fault != 0) {
        printf("fault %u", values->fault);
        return;
    }
    printf("warnings %04x touch %u rise %.3f Pa %" PRId32 " uN %" PRId32 " nm sigma %" PRId32 " %" PRId32 " %" PRId32,
           (unsigned)values->warnings, values->touch, ft_pascals(values->rise, bits), values->force_un, values->indentation_nm,
           values->rise_sigma, values->force_sigma_un, values->indentation_sigma_nm);
    if (values->has_feedback) {
        printf(" feedback %" PRId32 " uN sigma %" PRId32, values->feedback_un, values->feedback_sigma_un);
    }
}

static void print_hello(const struct ft_hello *hello)
{
    printf(" firmware %u.%u.%u reset %u design %016" PRIx64 " tables %" PRIu32 " period %" PRIu32 " stored %u (%" PRIu32
           ") before %u %" PRIx32 " resets %u lost %" PRIu32 " outliers %" PRIu32 " dropped %" PRIu32 " refused %" PRIu32 " tips %u",
           hello->firmware[0], hello->firmware[1], hello->firmware[2], hello->reset_cause, hello->design_hash,
           hello->table_version, hello->report_period_us, hello->stored, hello->stored_number, hello->last_fault,
           hello->last_fault_detail, hello->resets_in_a_row, hello->samples_lost, hello->samples_rejected,
           hello->frames_dropped, hello->commands_refused, hello->tips);
}

static void print_answer(const struct ft_answer *answer)
{
    printf(" tip %u command %02x sequence %u outcome %u findings %04x", answer->tip, answer->command,
           answer->command_sequence, answer->outcome, answer->findings);
    if (answer->has_known) {
        printf(" %" PRId32 " uN sigma %" PRId32 " curvature %" PRId32 " sigma %" PRId32, answer->force_un,
               answer->force_sigma_un, answer->curvature_per_km, answer->curvature_sigma_per_km);
    }
}

static void print_frame(const struct ft_frame *frame)
{
    printf("version %u kind %u sequence %u time %" PRIu64 " us dropped %u", frame->version, frame->kind, frame->sequence,
           frame->time_us, frame->dropped);
    switch (frame->kind) {
    case FT_HELLO:
        print_hello(&frame->of.hello);
        break;
    case FT_ANSWER:
        print_answer(&frame->of.answer);
        break;
    case FT_TIP_HELLO: {
        const struct ft_tip_hello *hello = &frame->of.tip_hello;
        printf(" tip %u ", hello->tip);
        for (const char *letter = hello->name; *letter != 0; letter++) {
            /* A line stays one. */
            putchar((unsigned char)*letter < 0x20 ? '?' : *letter);
        }
        printf(" design %016" PRIx64 " tables %" PRIu32 " period %" PRIu32 " stored %u (%" PRIu32 ") outliers %" PRIu32,
               hello->design_hash, hello->table_version, hello->report_period_us, hello->stored, hello->stored_number,
               hello->samples_rejected);
        break;
    }
    case FT_TIP_DATA:
        printf(" sequence %u offset %" PRIu32 " bytes ", frame->of.tip_data.command_sequence, frame->of.tip_data.offset);
        for (uint8_t i = 0; i < frame->of.tip_data.length; i++) {
            printf("%02x", frame->of.tip_data.bytes[i]);
        }
        break;
    case FT_BAND: {
        const struct ft_band *band = &frame->of.band;
        printf(" tip %u object unknown from %.3f Pa", band->tip, ft_pascals(band->from, frame->fraction_bits));
        for (uint8_t i = 0; i < band->count; i++) {
            const struct ft_band_row *row = &band->rows[i];
            /* Of a reading of 1 N and 1 mm in this row. */
            row = ft_band_at(band, frame->fraction_bits, row->to, frame->fraction_bits);
            printf(" to %.3f Pa force %.0f to %.0f uN indentation %.0f to %.0f nm", ft_pascals(row->to, frame->fraction_bits),
                   ft_band_end(1000000, row->force[0]), ft_band_end(1000000, row->force[1]),
                   ft_band_end(1000000, row->indentation[0]), ft_band_end(1000000, row->indentation[1]));
        }
        break;
    }
    default:
        for (uint8_t tip = 0; tip < frame->tips; tip++) {
            print_values(tip, &frame->of.values[tip], frame->fraction_bits);
        }
    }
    printf("\n");
}

static int frames(void)
{
    static struct ft_reader reader;
    static struct ft_frame frame;
    int byte;
    while ((byte = getchar()) != EOF) {
        enum ft_result result = ft_push(&reader, (uint8_t)byte, &frame);
        if (result == FT_WHOLE) {
            print_frame(&frame);
        } else if (result != FT_NONE) {
            printf("no frame: %s\n", RESULTS[result]);
        }
    }
    return 0;
}

static int tip_file(void)
{
    static const char *const results[] = {"ok", "magic", "layout", "short", "check", "section", "field"};
    static uint8_t bytes[65536];
    static struct ft_tip tip;
    size_t length = fread(bytes, 1, sizeof bytes, stdin);
    enum ft_tip_result result = ft_tip_read(&tip, bytes, length);
    if (result != FT_TIP_OK) {
        printf("no tip: %s\n", results[result]);
        return 1;
    }
    printf("%s design %016" PRIx64 " certificate %016" PRIx64 " tables %" PRIu32 " check %08" PRIx32 " bytes %" PRIu32 "\n",
           tip.name, tip.hash, tip.certificate, tip.table_version, tip.check, tip.length);
    printf("rest %" PRId32 " Pa to %" PRId32 " Pa, range %" PRId32 " to %" PRId32 " Pa %s, resolution %" PRId32
           " mPa, noise %" PRId32 " mPa, transducer %u address %02x\n",
           tip.rest_pressure_pa, tip.maximum_pressure_pa, tip.range_pa[0], tip.range_pa[1],
           tip.absolute ? "absolute" : "gauge", tip.resolution_mpa, tip.noise_mpa, tip.transducer, tip.address);
    printf("tables to %" PRId32 " counts of 1/2^%u Pa, %" PRIu32 " words; relaxation %d object %d zero %d\n", tip.last_rise,
           tip.fraction_bits, tip.table_words, tip.has_relaxation, tip.has_object, tip.has_zero);
    if (tip.has_calibration) {
        printf("calibration zero %" PRId32 " mPa at %" PRId32 ", %" PRId32 " mPa/K, gain %" PRId32 "\n", tip.zero_mpa,
               tip.zero_temperature, tip.zero_mpa_per_kelvin, tip.gain_ppm);
    }
    return 0;
}

static int encode(int count, char **words)
{
    uint8_t payload[68];
    uint8_t out[FT_MAX_FRAME];
    size_t length = 0;
    const char *text = count > 3 ? words[3] : "";
    for (size_t i = 0; i + 1 < strlen(text) && length < sizeof payload; i += 2) {
        char digits[3] = {text[i], text[i + 1], 0};
        payload[length++] = (uint8_t)strtoul(digits, NULL, 16);
    }
    uint8_t kind = (uint8_t)strtoul(words[1], NULL, 16);
    uint16_t sequence = (uint16_t)strtoul(words[2], NULL, 10);
    size_t bytes = strcmp(words[0], "-") == 0
        ? ft_command(out, kind, sequence, payload, length)
        : ft_hand_command(out, (uint8_t)strtoul(words[0], NULL, 10), kind, sequence, payload, length);
    fwrite(out, 1, bytes, stdout);
    return 0;
}

int main(int count, char **words)
{
    if (count == 1) {
        return frames();
    }
    if (count == 2 && strcmp(words[1], "tip") == 0) {
        return tip_file();
    }
    if ((count == 5 || count == 6) && strcmp(words[1], "encode") == 0) {
        return encode(count - 2, words + 2);
    }
    fputs("usage: read_frames [tip | encode TIP KIND SEQUENCE [PAYLOAD]]\n", stderr);
    return 2;
}
