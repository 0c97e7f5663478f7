function text = number_text(value)
%NUMBER_TEXT  A short text that reads back to the same number.
if isinteger(value)
    if value < 0
        text = sprintf('%d', value);
    else
        text = sprintf('%u', value);  % in Octave %d has six digits of numbers beyond int64
    end
    return
end
value = double(value);
text = sprintf('%.15g', value);
if str2double(text) ~= value
    text = sprintf('%.17g', value);
end
text = lower(text);  % nan and inf, as the program has them
end
